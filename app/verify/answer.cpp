/// Judging by the source's accuracy and by the error that rosin states itself.
#include "app/verify/answer.hpp"

#include <fmt/format.h>

#include <algorithm>
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

Verdict compare_texts(Answer& answer, const Wanted& wanted, const ordered_json& got) {
  answer.text = got.is_string() ? got.get<std::string>() : got.dump();
  const bool same = std::holds_alternative<bool>(wanted)
                        ? got == ordered_json(std::get<bool>(wanted))
                        : got.is_string() && answer.text == std::get<std::string>(wanted);
  return same ? Verdict::agrees : Verdict::disagrees;
}

Verdict compare_numbers(Answer& answer, const std::vector<double>& wanted) {
  double furthest = -1;
  bool resolved = true;
  for (std::size_t i = 0; i < wanted.size(); ++i) {
    const double accuracy = answer.question->accuracy[i];
    const double error = std::isnan(answer.error[i]) ? 0 : answer.error[i];
    const double share = std::abs(answer.got[i] - wanted[i]) / (accuracy + error);
    resolved &= error <= accuracy;
    if (share > furthest) furthest = share, answer.worst = i;
    if (std::isinf(error)) answer.worst = i;
  }
  return furthest > 1 ? Verdict::disagrees : resolved ? Verdict::agrees : Verdict::undecided;
}

void take_numbers(Answer& answer, const ordered_json& got, const ordered_json& stated) {
  const auto size = answer.wanted().size();
  if (got.is_array() != answer.question->list)
    throw InputError(got.is_array() ? "a list came out where one number is wanted"
                                    : "one value came out where a list is wanted");
  answer.got = numbers_of(got);
  if (answer.got.size() != size)
    throw InputError(fmt::format("{} numbers are wanted, {} came out", size, answer.got.size()));
  if (!std::ranges::all_of(answer.got, [](double x) { return std::isfinite(x); }))
    throw InputError(fmt::format("'{}' holds no number", answer.question->field->text()));
  answer.error = numbers_of(stated);
  answer.error.resize(size, answer.error.size() == 1 ? answer.error.front() : std::nan(""));
  if (answer.question->error && std::ranges::any_of(answer.error, [](double x) { return std::isnan(x); }))
    throw InputError(fmt::format("'{}' holds no error of it", answer.question->error->text()));
}

/// Against the number wanted, or the one that rosin is known to give in place of it.
Verdict compare(Answer& answer, const Wanted& wanted, const ordered_json& got) {
  const auto* numbers = std::get_if<std::vector<double>>(&wanted);
  return numbers ? compare_numbers(answer, *numbers) : compare_texts(answer, wanted, got);
}

std::string reason_of(Verdict verdict) {
  return verdict == Verdict::undecided   ? "the stated error is larger than the source's accuracy"
         : verdict == Verdict::disagrees ? "further apart than accuracy and error allow"
                                         : "";
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
    case Verdict::not_answered:
      return "not answered";
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
    if (!answer.wanted().empty())
      take_numbers(answer, got, question.error ? question.error->of(document) : question.field->error_of(document));
    if (!question.differs.empty() && compare(answer, question.instead, got) == Verdict::agrees) {
      compare(answer, question.wanted, got);  // what the table shows
      answer.verdict = Verdict::differs;
      answer.reason = question.differs;
      return;
    }
    answer.verdict = compare(answer, question.wanted, got);
    answer.reason = reason_of(answer.verdict);
    if (!question.differs.empty() && answer.verdict == Verdict::agrees) {
      answer.verdict = Verdict::no_longer_differs;
      answer.reason = "the case says why it would differ: " + question.differs;
    }
  } catch (const InputError& error) {
    answer.got.clear();
    answer.verdict = Verdict::failed;
    answer.reason = error.what();
    if (const auto detail = document.find("outcome_detail"); detail != document.end() && detail->is_string())
      answer.reason += fmt::format(" ({})", detail->get<std::string>());
  }
}

}  // namespace rosin::app::verify
