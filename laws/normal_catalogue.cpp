/// Cards of normal laws, with units that follow from exponents written by these.
#include "laws/normal_catalogue.hpp"

#include <tuple>

namespace rosin::laws {

namespace {

NormalEntry linear() {
  NormalEntry entry{&LinearContact::card, {}};
  std::apply(
      [&](const auto&... field) {
        (entry.parameters.push_back(
             {{std::string(field.name), std::string(field.unit), field.range, std::string(field.meaning)}, "0"}),
         ...);
      },
      LinearContact::parameters);
  entry.parameters.front().value = "required";
  entry.parameters.push_back({{"lift_off", "", {0, 1}, "the contact only presses"}, "true"});
  return entry;
}

NormalEntry power() {
  constexpr Range size{0, 1e60};
  using Law = PowerContact;
  return {&Law::card,
          {{{"coefficient", "N/m^m", {1e-30, 1e60}, "pressure over the approach to its exponent; Pa/m^m of an area"},
            "required"},
           {{"exponent", "1", Law::exponents, "exponent m of the contact's pressure"}, "1"},
           {{"damping", "N s/m^(l+1)", size, "damping of the contact on approach; Pa s/m^(l+1) of an area"}, "0"},
           {{"separation_damping", "N s/m^(l+1)", size, "damping of the contact on separation"}, "damping"},
           {{"damping_exponent", "1", Law::damping_exponents, "exponent l of the contact's damping"}, "exponent"},
           {{"adhesion", "", {0, 1}, "the pressure may fall below 0 while surfaces part fast"}, "false"},
           {{"bound", "", {0, 1}, "load that friction is a part of: \"elastic\", or \"pressure\" with its damping"},
            "elastic"},
           {{"bound_coefficient", "N/m^m_T", size, "else of the bound of friction, over the approach to its exponent"},
            "coefficient"},
           {{"bound_exponent", "1", Law::exponents, "exponent m_T of the bound of friction"}, "exponent"}}};
}

}  // namespace

const std::vector<NormalEntry>& normal_catalogue() {
  static const std::vector<NormalEntry> list = {linear(), power()};
  return list;
}

}  // namespace rosin::laws
