/// The verb merge: shares of a plane put together, and what a plane would take on many processes.
#include <fmt/ranges.h>

#include <algorithm>
#include <chrono>
#include <map>

#include "analysis/planes/map.hpp"
#include "analysis/planes/parts.hpp"
#include "analysis/planes/schedule.hpp"
#include "app/results/result.hpp"
#include "app/verbs/job.hpp"
#include "app/verbs/partial.hpp"
#include "app/verbs/plane_job.hpp"
#include "app/verbs/stopping.hpp"
#include "app/verbs/verb.hpp"

namespace rosin::app::verbs {

namespace {

namespace fs = std::filesystem;
using analysis::planes::Partition;
using analysis::planes::Share;
using nlohmann::ordered_json;

/// The journals in the folders that are named, by default the results folder, and those that are named themselves.
std::vector<fs::path> journals_of(const Request& request, const fs::path& results, std::size_t parts) {
  std::vector<fs::path> places(request.from.begin(), request.from.end()), found;
  if (places.empty()) places.push_back(results);
  for (const auto& place : places) {
    if (!fs::exists(place)) throw InputError(fmt::format("--from {}: no such file or folder", place.string()));
    if (!fs::is_directory(place)) {
      found.push_back(place);
      continue;
    }
    for (const auto& entry : fs::directory_iterator(place))
      if (share_of_journal(entry.path().filename().string(), parts)) found.push_back(entry.path());
  }
  std::ranges::sort(found);
  return found;
}

/// Refuses a plane with holes, and says by which commands they are filled.
void require_all(const Request& request, const Partition& partition, const KnownPoints& known,
                 const std::vector<fs::path>& journals) {
  if (known.count() == partition.points()) return;
  std::map<int, int> counts;  // of journals by the number of shares
  for (const auto& path : journals)
    if (const auto share = share_of_journal(path.filename().string(), partition.count())) ++counts[share->count];
  const int count =
      counts.empty() ? 1 : std::ranges::max_element(counts, {}, [](const auto& c) { return c.second; })->first;
  std::vector<std::size_t> missing(std::size_t(count), 0);
  const auto shares = partition.shares(count);
  for (std::size_t part = 0; part < partition.count(); ++part)
    partition.for_each(part, [&](std::size_t i, int, int) { missing[std::size_t(shares[part])] += !known.has(i); });
  std::vector<std::string> commands;
  constexpr std::size_t most = 20;
  std::size_t more = 0;
  for (int index = 0; index < count; ++index) {
    const auto lacking = missing[std::size_t(index)];
    if (lacking == 0) continue;
    if (commands.size() < most)
      commands.push_back(fmt::format("{} ({} points)", command_of(request, "map", {index, count}), lacking));
    else
      ++more;
  }
  throw InputError(fmt::format(
      "{} of {} points are missing in {}; compute them by\n  {}{}", partition.points() - known.count(),
      partition.points(), journals.empty() ? "no journal of a map" : fmt::format("{} journals", journals.size()),
      fmt::join(commands, "\n  "), more > 0 ? fmt::format("\n  and {} shares more", more) : std::string()));
}

Status forecast(const Job& job, const Partition& partition, const KnownPoints& known) {
  if (known.costs().empty())
    throw InputError(fmt::format(
        "{}: no part of the plane has been computed yet, so that nothing is known of its time; a sample of it is "
        "computed by '{}'",
        job.results().string(),
        command_of(job.request(), "map", {0, int(std::clamp<std::size_t>(partition.count(), 1, 100))})));
  const auto seconds = analysis::planes::filled_up(known.costs(), partition.count());
  double all = 0;
  for (const double part : seconds) all += part;
  job.say("{} parts, of which {} are computed, take {:.3g} s of one processor, the longest {:.3g} s", partition.count(),
          known.costs().size(), all, std::ranges::max(seconds));
  job.say("  {:>8} {:>12} {:>12}", "ranks", "time (s)", "efficiency");
  auto rows = ordered_json::array();
  for (const std::size_t ranks : {1, 10, 100, 1000, 10'000}) {
    const auto plan = analysis::planes::schedule(partition, seconds, ranks);
    job.say("  {:>8} {:>12.3g} {:>12.2f}", ranks, plan.seconds, plan.efficiency);
    rows.push_back({{"ranks", ranks}, {"seconds", plan.seconds}, {"efficiency", plan.efficiency}});
  }
  if (job.request().json) {
    ordered_json document = {
        {"verb", "merge"}, {"parts", partition.count()},           {"computed", known.costs().size()},
        {"seconds", all},  {"longest", std::ranges::max(seconds)}, {"forecast", rows}};
    write_output(results::text(document));
  }
  return done;
}

Status merge(const Request& given) {
  Request request = given;
  request.verb = "map";  // whose results are written
  Job job(request);
  if (job.scene().string) throw InputError("a plane of strings has no shares; 'rosin map' computes it");
  if (job.scene().task<analysis::planes::MapOptions>().y.values.empty())
    throw InputError("[map] has one axis, which has no shares; 'rosin map' computes it");
  const PlaneJob plane(job);
  const auto partition = analysis::planes::partition_of(plane.options, !plane.of_slider);
  const auto journals = journals_of(request, job.results(), partition.count());
  KnownPoints known(RecordForm(plane.metrics, plane.points));
  for (const auto& path : journals) read_journal(path, plane.key, known);
  if (request.forecast) return forecast(job, partition, known);
  require_all(request, partition, known, journals);
  job.claim_folder();
  const auto begin = std::chrono::steady_clock::now();
  analysis::planes::MapHooks hooks;
  hooks.known = [&](std::size_t i) { return known.point(i); };
  MapResult result{plane.compute(hooks), 0};
  result.seconds = seconds_since(begin);
  if (result.map.outcome.ending == Ending::interrupted) return stopped_early(request, "the journals are as they were");
  const auto status = plane.write(result, known.costs());
  job.say("The {} journals are left where they are.", journals.size());
  return status;
}

}  // namespace

Verb merge_verb() {
  return {.name = "merge",
          .help = "put the shares of a plane together, as 'rosin map --shard K/N' has computed them",
          .example = "rosin merge examples/bristol-board-plane.toml",
          .operands = {scene_operand},
          .options = scene_options(
              {{"--exact", &Request::exact, "the shares were computed with --exact"},
               {"--from", &Request::from, "folder with journals of shares, or one of them; default the results folder"},
               {"--forecast", &Request::forecast,
                "write no plane, but say what it takes on 1 to 10000 ranks, from the parts that are there"}}),
          .without_scene = merge};
}

}  // namespace rosin::app::verbs
