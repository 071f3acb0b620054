/// One verb at work on one scene: where its results go and who is told.
#pragma once
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "app/results/manifest.hpp"
#include "app/results/result.hpp"
#include "app/scene/scene.hpp"
#include "app/verbs/verbs.hpp"
#include "core/console.hpp"
#include "core/results_folder.hpp"

namespace rosin::app::verbs {

/// The unit in which the scene that is being computed writes numbers of an SI unit; that unit where it writes none, or
/// several.
scene::WrittenUnit written_unit(std::string_view si);
/// A value in SI with the digits that its error leaves meaningful, in the unit of the scene: "22.58705580 ± 3e-08 um".
std::string justified(double value, double error, std::string_view si);
/// The same of a quantity that is never negative: where the error is larger than the value, the range that it leaves,
/// "0 … 8".
std::string justified_above_zero(double value, double error, std::string_view si);

double seconds_since(std::chrono::steady_clock::time_point begin);

/// The largest of |error/value| where both are known.
class Reached {
 public:
  void add(double value, double error) {
    if (std::isfinite(value) && std::isfinite(error) && value != 0)
      largest_ = std::max(largest_, std::abs(error / value));
  }
  double value() const { return largest_; }

 private:
  double largest_ = 0;
};

/// The folder that is asked for, or out/<scene>.
std::filesystem::path results_folder(const Request&);

class Job {
 public:
  /// Reads the scene and makes the folder. \throws InputError
  explicit Job(const Request&);
  Job(const Job&) = delete;
  ~Job();

  const Request& request() const { return request_; }
  scene::Scene& scene() { return scene_; }
  const scene::Scene& scene() const { return scene_; }
  /// Where files are written; finish() puts them into the results folder, all together.
  const std::filesystem::path& folder();
  /// The results folder itself, for what outlives an interrupted run.
  const std::filesystem::path& results() const { return folder_; }
  results::Manifest& manifest() { return manifest_; }

  /// A line of the summary.
  template <class... Args>
  void say(fmt::format_string<Args...> text, Args&&... args) const {
    if (request_.json || request_.quiet) return;
    print("{}\n", fmt::format(text, std::forward<Args>(args)...));
  }
  void note(std::string_view text) const;
  template <class... Args>
  void explain(fmt::format_string<Args...> text, Args&&... args) const {
    if (!request_.explain) return;
    tell("plan: {}\n", fmt::format(text, std::forward<Args>(args)...));
  }
  /// What all plans have in common: the unknowns that are kept.
  void explain_model() const;

  /// No other process writes into the folder from here on. \throws InputError where one does
  void claim_folder() { claim_.emplace(folder_); }
  /// The results are named as those of another verb, which the scene asks for.
  void results_of(std::string verb);
  /// An empty result of this work.
  results::Result result(Outcome outcome = {}) const { return {scene_, manifest_.verb, std::move(outcome)}; }

  /// A complete result of an earlier run of the verb is in the folder.
  bool whole_result_is_there() const;

  /// Writes the result's tables in the formats that are asked for, draws the scripts (*.gp) among the files, writes the
  /// document and the manifest, each under the verb's name and as the folder's latest, in place of all that an earlier
  /// result of the verb has left; prints the document if asked. A failure without tables and files leaves a whole
  /// earlier result as it is. Call last.
  /// \param files  that stand beside the tables: scripts and their data, sounds
  Status finish(const results::Result&, std::vector<std::string> files = {});

 private:
  void say_what_is_replaced() const;
  void put_in_place() const;

  const Request& request_;
  scene::Scene scene_;
  const scene::WrittenUnits* units_before_ = nullptr;  ///< of the job within which this one is done
  std::filesystem::path folder_;
  std::string label_;  ///< of the results
  results::Manifest manifest_;
  std::optional<FolderClaim> claim_;
  std::filesystem::path staging_;  ///< empty until files are written
};

/// Draws the scripts (*.gp) among the manifest's files, unless no pictures are wanted; the manifest then knows the
/// pictures and, by their checksums, the scripts.
void draw_pictures(const Request&, const std::filesystem::path& folder, results::Manifest&);
/// Writes a document and its manifest, each under the label's name and as the folder's latest.
void write_results(const std::filesystem::path& folder, const std::string& label, const std::string& document,
                   const std::string& manifest);

/// Scripts of a results folder that are as some verb's manifest has them, and the others.
struct Scripts {
  std::vector<std::string> ours, foreign;
};
Scripts scripts_of(const std::filesystem::path& folder);

}  // namespace rosin::app::verbs
