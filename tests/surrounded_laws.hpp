/// Laws in all surroundings that they take, for tests that ask something of each.
#pragma once
#include <vector>

#include "laws/catalogue.hpp"
#include "laws/formula.hpp"
#include "laws/heating.hpp"
#include "laws/smoothing.hpp"
#include "oscillators/model.hpp"
#include "tests/laws/formula_texts.hpp"

namespace rosin::tests {

/// Each shipped law and two from text, bare, smoothed, heated, with another clock and behind springs, as far as it
/// takes them.
inline std::vector<oscillators::Model> surrounded_laws() {
  std::vector<oscillators::Model> models;
  auto list = laws::catalogue();
  for (const auto& text : {text::ageing(), text::stribeck()}) list.push_back(laws::make_formula(text));
  // A width in which all slip rates of tests lie: beyond it friction falls, which behind a spring may have no answer.
  for (std::size_t i = 0; i < laws::smoothing_names().size(); ++i)
    list.push_back(
        laws::smoothed(laws::find_law(i % 2 == 0 ? "hyperbolic" : "slip-weakening"), {laws::Smoothing::Type(i), 5e-3}));
  for (const auto& law : list) {
    oscillators::Model model;
    model.law = law;
    model.drive = {.speed = 3e-4, .normal_load = 2.0, .force = 0.0};
    models.push_back(model);
    if (!law->deflects()) {
      auto heated = model;
      heated.law = laws::heated(law, {.resistance = 2e4, .time = 0.02, .softening = 30});
      models.push_back(heated);
    }
    if (law->has_states()) {
      model.lambda = 3;
      models.push_back(model);
    }
    if (law->set_valued()) continue;
    if (law->has_slip_rate()) {
      model.contact_stiffness.tangential = 3e5;
      models.push_back(model);
      model.contact_stiffness = {.tangential = infinity, .per_load = 2e5};
      models.push_back(model);
    }
    model.contact_stiffness = {.tangential = infinity, .per_load = 2e5, .damping = 40};
    models.push_back(model);
    model.contact_stiffness = {.tangential = 3e5, .per_load = infinity, .damping_per_load = 30};
    models.push_back(model);
  }
  return models;
}

}  // namespace rosin::tests
