/// The scene of a verb, as tests ask for it.
#pragma once
#include <string>
#include <vector>

#include "app/verbs/verbs.hpp"

namespace rosin::tests {

/// \param verb "design" is that of compare --design.
inline app::scene::Scene scene_of(const std::string& path, const std::vector<std::string>& overrides,
                                  const std::string& verb, std::string_view experiment = {}) {
  app::Request request;
  request.verb = verb == "design" ? "compare" : verb;
  request.design = verb == "design";
  request.experiment = experiment;
  request.target = path;
  request.overrides = overrides;
  return app::verbs::read_scene(request);
}

}  // namespace rosin::tests
