/// What rosin answers to a question of the dossier, and what is to be thought of it.
#pragma once
#include <cmath>
#include <nlohmann/json_fwd.hpp>
#include <span>
#include <string>
#include <vector>

#include "app/verify/case.hpp"

namespace rosin::app::verify {

/// The first two are as they should be; `differs` and `not_reproduced` are accounted for by the case.
enum class Verdict {
  agrees,          ///< within the source's accuracy and the stated error, which is no larger
  differs,         ///< it does not, and the case says why
  not_reproduced,  ///< rosin cannot be asked, and the case says why
  disagrees,
  undecided,          ///< the stated error is larger than the source's accuracy
  no_longer_differs,  ///< it agrees, though the case says why it would not
  failed,             ///< no number came out
  not_answered,       ///< the work was stopped before
};
const char* name(Verdict);
/// Whether nothing is left to explain.
constexpr bool accounted_for(Verdict verdict) { return verdict <= Verdict::not_reproduced; }

struct Answer {
  std::string name;  ///< of the case; behind it, where it asks several questions, the number of this one
  const Case* of = nullptr;
  const Question* question = nullptr;
  std::string command;  ///< that gives the answer
  Verdict verdict = Verdict::not_answered;
  std::string reason;              ///< of everything but agreement
  std::vector<double> got, error;  ///< SI; one for each number wanted; errors are NaN where none is stated
  std::string text;                ///< of an answer that is no number
  std::size_t worst = 0;           ///< the number that is furthest from what was wanted, for what is allowed

  std::span<const double> wanted() const;  ///< SI; none where the answer is no number
  bool has_number() const { return !wanted().empty() && got.size() == wanted().size(); }
  /// Of the worst number.
  double difference() const { return std::abs(got[worst] - wanted()[worst]); }
  double over_accuracy() const { return difference() / question->accuracy[worst]; }
  double over_error() const { return difference() / error[worst]; }
};

/// Takes the answer out of the verb's document and judges it.
void judge(Answer&, const nlohmann::ordered_json& document);

}  // namespace rosin::app::verify
