/// Symbols of quantities and of numbers of a scene, as docs/glossary.md has them.
#pragma once
#include <string>
#include <string_view>

namespace rosin::app::output {

/// "v" of "slip_rate", "V" of "drive.speed", "σ₀" of "law.sigma0", "μ_s" of "law.mu_s"; empty where there is none.
std::string symbol_of(std::string_view name);
struct Words {
  std::string name, symbol;  ///< either may be empty
};
/// "slip_rate" as "slip rate" and "v".
Words in_words(std::string name);
/// The same as it is read: "slip rate v".
std::string readable(std::string name);

}  // namespace rosin::app::output
