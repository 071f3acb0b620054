/// The file qdyn.in, which QDYN reads line by line: numbers first, then anything. Its lines have changed with the
/// releases, and are told apart by how many numbers they hold:
///   MESHDIM | N | L W | THETA_LAW | RNS_LAW | SIGMA_CPL, then
///   releases with a MATLAB wrapper: number of equations;   3.x: restart, restart time, number of faults;
///   since 1.1: features, 2 or 3;
///   six or more of output | VS MU LAM … V_TH (4 or 6) | TPER APER | DTTRY DTMAX TMAX ACC | NSTOP | 2 and 3 of coupling
///   | since 2.0: FAULT_TYPE SOLVER; SIGMA V_0 TH_0 A B DC V1 V2 MU_SS V_SS IOT IASP, then CO, then V_PL.
#include <fmt/format.h>

#include <cctype>
#include <charconv>
#include <string>
#include <vector>

#include "app/imports/qdyn.hpp"
#include "core/error.hpp"

namespace rosin::app::imports {

namespace {

struct Line {
  int number;
  std::vector<double> values;
};

/// The numbers that a line begins with, as Fortran writes them: "1d-9" too.
std::vector<double> numbers_of(std::string_view line) {
  std::vector<double> values;
  while (true) {
    const auto begin = line.find_first_not_of(" \t\r,");
    if (begin == std::string_view::npos) return values;
    line.remove_prefix(begin);
    auto word = std::string(line.substr(0, line.find_first_of(" \t\r,")));
    line.remove_prefix(word.size());
    if (word.find_first_of("0123456789") == std::string::npos) return values;
    for (auto& c : word)
      if (c == 'd' || c == 'D') c = 'e';
    const char* first = word.data() + (word.front() == '+' ? 1 : 0);
    double value = 0;
    const auto read = std::from_chars(first, word.data() + word.size(), value);
    if (read.ec != std::errc() || read.ptr != word.data() + word.size()) return values;
    values.push_back(value);
  }
}

class Input {
 public:
  Input(const std::string& path, std::string_view text) : path_(path) {
    for (int number = 1; !text.empty(); ++number) {
      const auto end = std::min(text.find('\n'), text.size());
      const auto line = text.substr(0, end);
      if (line.find_first_not_of(" \t\r") != std::string_view::npos) lines_.push_back({number, numbers_of(line)});
      text.remove_prefix(std::min(text.size(), end + 1));
    }
  }

  QdynParameters parameters() {
    take(1, {"MESHDIM"});
    if (found_.at("MESHDIM").value != 0) return found_;  // whose lines differ, and which no scene has
    take(1, {""});
    take(2, {"L", "W"});
    take(1, {"THETA_LAW"});
    take(1, {"RNS_LAW"});
    take(1, {"SIGMA_CPL"});
    if (found_.at("RNS_LAW").value == 3) return found_;
    std::vector<const Line*> single;
    while (at_ < lines_.size() && lines_[at_].values.size() == 1) single.push_back(&lines_[at_++]);
    if (single.size() == 3)
      give("FEAT_RESTART", single[0]->values[0], single[0]->number);
    else if (single.size() > 1)
      refuse(single[1]->number, "holds one number where 3 or more are due: features or intervals of output");
    if (at_ < lines_.size() && lines_[at_].values.size() <= 3) {
      const bool three = lines_[at_].values.size() == 3;
      take(2, {"FEAT_STRESS_COUPL", three ? "FEAT_TP" : "FEAT_COHESION", "FEAT_LOCALISATION"});
    }
    take(6, {});
    const bool damage = at_ < lines_.size() && lines_[at_].values.size() >= 6;
    take(4,
         damage ? std::vector<std::string>{"VS", "MU", "LAM", "D", "HD"} : std::vector<std::string>{"VS", "MU", "LAM"});
    take(2, {"TPER", "APER"});
    take(4, {"", "", "TMAX", "ACC"});
    take(1, {"NSTOP"});
    take(2, {});
    take(3, {});
    if (at_ < lines_.size() && lines_[at_].values.size() == 2) take(2, {});
    take(12, {"SIGMA", "V_0", "TH_0", "A", "B", "DC", "V1", "V2", "MU_SS", "V_SS", "", "", "CO", "V_PL"});
    if (!found_.contains("V_PL")) {  // before release 2 the load point moves at the reference velocity
      const auto& reference = found_.at("V_SS");
      found_["V_PL"] = {reference.value, reference.line, "V_SS"};
    }
    return found_;
  }

 private:
  [[noreturn]] void refuse(int line, std::string_view why) const {
    throw InputError(fmt::format("{}:{}: {}", path_, line, why));
  }

  void give(const std::string& name, double value, int line) { found_[name] = {value, line, name}; }

  /// The next line, of `least` numbers or more, by name as far as they have names.
  void take(std::size_t least, const std::vector<std::string>& names) {
    std::string listed;
    for (const auto& name : names)
      if (!name.empty()) listed += (listed.empty() ? " (" : ", ") + name;
    if (!listed.empty()) listed += ")";
    if (at_ == lines_.size())
      throw InputError(fmt::format("{}: ends where a line of {} numbers{} is due", path_, least, listed));
    const auto& line = lines_[at_++];
    if (line.values.size() < least)
      refuse(line.number, fmt::format("holds {} numbers where {} are due{}", line.values.size(), least, listed));
    for (std::size_t i = 0; i < std::min(names.size(), line.values.size()); ++i)
      if (!names[i].empty()) give(names[i], line.values[i], line.number);
  }

  std::string path_;
  std::vector<Line> lines_;
  std::size_t at_ = 0;
  QdynParameters found_;
};

}  // namespace

bool is_qdyn_input(std::string_view text) {
  const auto begin = text.find_first_not_of(" \t\r\n");
  if (begin == std::string_view::npos || !std::isdigit(static_cast<unsigned char>(text[begin]))) return false;
  const auto line = text.substr(begin, text.find('\n', begin) - begin);
  return numbers_of(line).size() == 1;
}

QdynParameters read_qdyn_input(const std::string& path, std::string_view text) {
  return Input(path, text).parameters();
}

}  // namespace rosin::app::imports
