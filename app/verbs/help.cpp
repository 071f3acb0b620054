/// The verb help: what a verb needs, its options and their defaults, an example.
#include "app/verbs/verb.hpp"
#include "core/console.hpp"

namespace rosin::app::verbs {

namespace {

Status help(const Request& request) {
  print("{}", help_of(request.target));
  return done;
}

}  // namespace

Verb help_verb() {
  return {.name = "help",
          .help = "what a verb needs, its options and their defaults, and an example",
          .example = "rosin help cycle",
          .operands = {{"VERB", &Request::target, "a verb; all if left out", false}},
          .without_scene = help};
}

}  // namespace rosin::app::verbs
