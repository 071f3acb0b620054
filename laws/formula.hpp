/// Laws from text: a friction law that a user writes as formulas, with its units checked, compiled to tapes.
#pragma once
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "laws/expression.hpp"
#include "laws/law.hpp"

namespace rosin::laws {

/// A law as text. Expressions are in SI (laws/expression.hpp) and know v (slip rate), N (normal load), the parameters,
/// the states and the definitions; `slip_rate` knows mu (coefficient of friction) instead of v.
struct FormulaDescription {
  struct Parameter {
    Quantity quantity;  ///< its unit is coherent SI
    double value;
  };
  std::string title;
  std::vector<Parameter> parameters;
  std::vector<Quantity> states;
  std::vector<std::pair<std::string, std::string>> define;  ///< names of parts and what they stand for
  std::string friction;
  std::vector<std::string> rate, steady;  ///< of each state: dψ/dt for λ = 1, and ψ of steady sliding
  std::vector<std::string> rest;          ///< of each state after long rest; empty: that of the slowest creep
  std::vector<std::string> after_stop;    ///< of each state, what a stop makes of it; empty: nothing
  std::vector<std::string> size;          ///< of each state, what its changes are measured by; empty: its steady value
  std::string slip_rate;                  ///< v from mu; empty: none
  std::string kink;          ///< of states, none of them logarithmic: changes sign where friction or a rate has a kink
  std::string static_limit;  ///< largest coefficient at rest, of N and states; empty: the law is not set-valued
};

/// The law of that description. \throws ExpressionError (laws/expression.hpp) for text that is no law.
std::shared_ptr<const FrictionLaw> make_formula(const FormulaDescription&);

/// Asks a law from text, at its parameter values, over twelve decades of slip rate: whether it answers with numbers,
/// its friction is odd, its rate vanishes in the steady state, and its slip rate inverts its friction. \throws
/// ExpressionError for the expression that does not.
void check_formula(const FrictionLaw&);

}  // namespace rosin::laws
