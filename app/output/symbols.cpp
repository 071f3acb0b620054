/// The list of symbols, and the rule by which parameters of laws go: their names are the letters of the papers.
#include "app/output/symbols.hpp"

#include <algorithm>
#include <cctype>
#include <map>
#include <utility>

namespace rosin::app::output {

namespace {

using Pair = std::pair<std::string_view, std::string_view>;

constexpr Pair quantities[] = {{"time", "t"},
                               {"displacement", "x"},
                               {"velocity", "ẋ"},
                               {"slip_rate", "v"},
                               {"slip_rate_max", "v_max"},
                               {"slip_rate_min", "v_min"},
                               {"slip_rate_mean", "⟨v⟩"},
                               {"friction_force", "F"},
                               {"friction_coefficient", "μ"},
                               {"friction_max", "μ_max"},
                               {"friction_min", "μ_min"},
                               {"friction_mean", "⟨μ⟩"},
                               {"normal_load", "N"},
                               {"period", "T"},
                               {"frequency", "f"},
                               {"angular_frequency", "ω"},
                               {"growth_rate", "σ"},
                               {"damping_ratio", "ζ"},
                               {"first_lyapunov_coefficient", "ℓ₁"},
                               {"eigenvalues", "s"},
                               {"exponents", "λ"},
                               {"lyapunov", "λ₁"},
                               {"sum", "Σλ"},
                               {"stick_threshold", "ε"},
                               {"chi_square", "χ²"},
                               {"aic", "AIC"},
                               {"bic", "BIC"},
                               {"coherence", "γ²"},
                               {"recurrence", "T"},
                               {"force_drop", "ΔF"},
                               {"pressure", "p"},
                               {"drive.speed", "V"},
                               {"drive.normal_load", "N"},
                               {"drive.force", "f"},
                               {"oscillator.mass", "m"},
                               {"oscillator.stiffness", "k"},
                               {"oscillator.damping", "c"}};

constexpr Pair greek[] = {{"alpha", "α"}, {"beta", "β"},  {"gamma", "γ"},  {"delta", "δ"},
                          {"theta", "θ"}, {"kappa", "κ"}, {"lambda", "λ"}, {"mu", "μ"},
                          {"sigma", "σ"}, {"tau", "τ"},   {"phi", "φ"},    {"psi", "ψ"}};

constexpr std::string_view below[] = {"₀", "₁", "₂", "₃", "₄", "₅", "₆", "₇", "₈", "₉"};

bool is_digit(char c) { return std::isdigit(static_cast<unsigned char>(c)) != 0; }

/// "theta1" as θ₁, "mu_s" as μ_s; empty where a name is no letter.
std::string spelled(std::string_view name) {
  const auto end = std::ranges::find_if(name, [](char c) { return c == '_' || is_digit(c); }) - name.begin();
  auto letter = name.substr(0, std::size_t(end)), index = name.substr(std::size_t(end));
  const auto* found = std::ranges::find(greek, letter, &Pair::first);
  if (found != std::end(greek))
    letter = found->second;
  else if (letter.size() != 1)
    return "";
  const auto digits = index.substr(index.starts_with('_') ? 1 : 0);
  std::string symbol(letter);
  if (std::ranges::all_of(digits, is_digit))
    for (const char digit : digits) symbol += below[digit - '0'];
  else
    symbol += index;
  return symbol;
}

}  // namespace

std::string symbol_of(std::string_view name) {
  if (const auto* found = std::ranges::find(quantities, name, &Pair::first); found != std::end(quantities))
    return std::string(found->second);
  if (name.starts_with("law.")) name = name.substr(name.rfind('.') + 1);
  return name.find('.') == name.npos ? spelled(name) : "";
}

Words in_words(std::string name) {
  static const std::map<std::string, Words> reworded = {{"time", {"time", ""}},
                                                        {"displacement_x", {"displacement", "x"}},
                                                        {"displacement_y", {"displacement", "y"}},
                                                        {"slip_rate_max", {"largest slip rate", "v"}},
                                                        {"slip_rate_min", {"smallest slip rate", "v"}},
                                                        {"lyapunov", {"largest Lyapunov exponent", "λ₁"}}};
  if (const auto found = reworded.find(name); found != reworded.end()) return found->second;
  if (auto letter = spelled(name); !letter.empty()) return {"", letter};
  // Of one of several contacts: "slip_rate_2".
  if (const auto bar = name.rfind('_'); bar != name.npos && bar + 2 == name.size() && is_digit(name.back()))
    for (const char* of_contact : {"slip_rate", "friction_force", "friction_coefficient", "normal_load", "theta"})
      if (name.compare(0, bar, of_contact) == 0) {
        auto words = in_words(of_contact);
        words.symbol += below[std::size_t(name.back() - '0')];
        return words;
      }
  Words words{name, symbol_of(name)};
  std::ranges::replace(words.name, '_', ' ');
  return words;
}

std::string readable(std::string name) {
  const auto [words, symbol] = in_words(std::move(name));
  return words + (words.empty() || symbol.empty() ? "" : " ") + symbol;
}

}  // namespace rosin::app::output
