/// Numbers of results as a physicist reads them: symbol, unit and meaning of a key, digits by the error.
#pragma once
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>

namespace rosin::app::report {

/// What is known of a key of a document.
struct Known {
  std::string symbol, unit, meaning;  ///< empty where nothing is known
};
/// Of a key ("period", "slip_rate_2_max") or of a parameter's path ("drive.normal_load").
Known known(std::string_view key);
/// The unit of a number of a document, empty where none is known.
/// \param units those that the document states, of the number itself, or of the series whose maximum or mean it is
std::string unit_of(std::string_view key, const nlohmann::ordered_json& units);
/// That of the parameter along which a document goes: its "parameter".
std::string unit_of_parameter(const nlohmann::ordered_json& document);
/// "slip_rate" as it is read.
std::string readable(std::string key);

/// "8.4507·10⁻⁵"
std::string number_text(double value, int digits = 7);
/// With the digits that the error leaves meaningful; error NaN: none is known, 0: exact.
std::string number_text(double value, double error, int digits = 7);
/// The same with the unit, whose prefix suits the value: "22.58706 ± 3·10⁻⁸ s", "84.507 µm/s".
std::string amount(double value, std::string_view unit, double error, int digits = 7);
std::string amount(double value, std::string_view unit);

}  // namespace rosin::app::report
