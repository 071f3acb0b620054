/// Judging by the source's accuracy and by the error that rosin states itself.
#include "app/verify/answer.hpp"

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "core/error.hpp"

namespace rosin::app::verify {

using nlohmann::ordered_json;

namespace {

std::vector<double> numbers_of(const ordered_json& value) {
  std::vector<double> numbers;
  const auto add = [&](const ordered_json& one) {
    numbers.push_back(one.is_number() ? one.get<double>() : std::nan(""));
  };
  if (value.is_array())
    for (const auto& one : value) add(one);
  else
    add(value);
  return numbers;
}

/// What differs from what was wanted, in words; empty: nothing.
std::string compare_texts(Answer& answer, const ordered_json& got) {
  const auto& wanted = answer.question->wanted;
  answer.text = got.is_string() ? got.get<std::string>() : got.dump();
  if (const auto* truth = std::get_if<bool>(&wanted)) return got == ordered_json(*truth) ? "" : "another truth value";
  return got.is_string() && answer.text == std::get<std::string>(wanted) ? "" : "another text";
}

void compare_numbers(Answer& answer, const ordered_json& got, const ordered_json& stated) {
  const auto wanted = answer.wanted();
  answer.got = numbers_of(got);
  if (answer.got.size() != wanted.size() || got.is_array() != answer.question->list)
    throw InputError(fmt::format("{} numbers are wanted, {} came out", wanted.size(), answer.got.size()));
  answer.error = numbers_of(stated);
  answer.error.resize(wanted.size(), answer.error.size() == 1 ? answer.error.front() : std::nan(""));
  double furthest = -1;
  bool resolved = true;
  for (std::size_t i = 0; i < wanted.size(); ++i) {
    if (!std::isfinite(answer.got[i])) throw InputError("no number came out");
    const double accuracy = answer.question->accuracy[i];
    const double error = std::isnan(answer.error[i]) ? 0 : answer.error[i];
    const double share = std::abs(answer.got[i] - wanted[i]) / (accuracy + error);
    resolved &= error <= accuracy;
    if (share > furthest) furthest = share, answer.worst = i;
    if (std::isinf(error)) answer.worst = i;
  }
  answer.verdict = furthest > 1 ? Verdict::disagrees : resolved ? Verdict::agrees : Verdict::undecided;
  if (answer.verdict == Verdict::disagrees) answer.reason = "further apart than accuracy and error allow";
  if (answer.verdict == Verdict::undecided) answer.reason = "the stated error is larger than the source's accuracy";
}

}  // namespace

const char* name(Verdict verdict) {
  switch (verdict) {
    case Verdict::agrees:
      return "agrees";
    case Verdict::differs:
      return "differs, as known";
    case Verdict::not_reproduced:
      return "not reproduced";
    case Verdict::disagrees:
      return "disagrees";
    case Verdict::undecided:
      return "undecided";
    case Verdict::no_longer_differs:
      return "no longer differs";
    case Verdict::failed:
      return "failed";
  }
  return "";
}

std::span<const double> Answer::wanted() const {
  const auto* numbers = std::get_if<std::vector<double>>(&question->wanted);
  return numbers ? std::span<const double>(*numbers) : std::span<const double>();
}

void judge(Answer& answer, const ordered_json& document) {
  const auto& question = *answer.question;
  try {
    const auto got = question.field->of(document);
    if (!answer.wanted().empty()) {
      compare_numbers(answer, got, question.error ? question.error->of(document) : question.field->error_of(document));
    } else {
      answer.reason = compare_texts(answer, got);
      answer.verdict = answer.reason.empty() ? Verdict::agrees : Verdict::disagrees;
    }
  } catch (const InputError& error) {
    answer.got.clear();
    answer.verdict = Verdict::failed;
    answer.reason = error.what();
    if (const auto detail = document.find("outcome_detail"); detail != document.end() && detail->is_string())
      answer.reason += fmt::format(" ({})", detail->get<std::string>());
    return;
  }
  if (question.differs.empty()) return;
  const bool agrees = answer.verdict == Verdict::agrees;
  answer.reason = agrees ? "the case says that it differs: " + question.differs : question.differs;
  answer.verdict = agrees ? Verdict::no_longer_differs : Verdict::differs;
}

}  // namespace rosin::app::verify
