/// Formulas over the numbers of a scene, by the parser of formula laws.
#include "analysis/inference/derived.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "laws/expression.hpp"

namespace rosin::analysis::inference {

namespace {

/// Paths of a subject as names, each an input of the graph from its first use on.
class Paths final : public laws::Names {
 public:
  Paths(laws::Graph& graph, const Subject& subject, std::vector<std::string>& used)
      : graph_(graph), subject_(subject), used_(used) {
    for (const auto& quantity : subject.model.parameters()) known_.push_back(quantity.name);
  }
  std::optional<laws::Measured> find(std::string_view word, int) override {
    if (word.find('.') == word.npos)
      return std::nullopt;  // pi, a function, or a name that the parser says the nearest path of
    const std::string path(word);
    const auto quantity = subject_.describe(path);
    const auto unit = parse_unit(quantity.unit);
    if (!unit || unit->factor != 1 || unit->offset)
      throw InputError(fmt::format("{} is in {}, which is no unit of SI", path, quantity.unit));
    const auto place = std::ranges::find(used_, path) - used_.begin();
    if (place == std::ssize(used_)) used_.push_back(path);
    return laws::Measured{graph_.input(int(place)), unit->dimension};
  }
  const std::vector<std::string>& known() const override { return known_; }
  bool paths() const override { return true; }

 private:
  laws::Graph& graph_;
  const Subject& subject_;
  std::vector<std::string>& used_;
  std::vector<std::string> known_;
};

/// The unit that a mechanician writes, where there is one.
std::string familiar_unit(const Dimension& dimension) {
  for (const char* unit : {"N", "N/m", "N s/m", "Pa", "J", "W", "N/s", "1/m"})
    if (parse_unit(unit)->dimension == dimension) return unit;
  return coherent_unit(dimension);
}

}  // namespace

DerivedNumber::DerivedNumber(std::string name, std::string_view text, const Subject& subject)
    : name_(std::move(name)), text_(text) {
  laws::Graph graph;
  Paths names(graph, subject, paths_);
  const auto whole = laws::parse_expression(graph, names, "fit.derived." + name_, text_);
  unit_ = familiar_unit(whole.dimension);
  std::vector<int> outputs = {whole.node};
  for (std::size_t k = 0; k < paths_.size(); ++k)
    outputs.push_back(graph.differentiate({&whole.node, 1}, int(k)).front());
  laws::ConstantPool pool;
  tape_ = laws::compile(graph, outputs, pool);
  constants_ = laws::compile_pool(graph, pool)(std::vector<double>());
}

DerivedNumber::Value DerivedNumber::at(std::span<const double> numbers) const {
  std::vector<const double*> inputs;
  for (const double& number : numbers) inputs.push_back(&number);
  const laws::TapeRun<double> run(tape_, constants_.data(), inputs.data());
  Value value{run[0], {}};
  for (std::size_t k = 1; k <= paths_.size(); ++k) value.slopes.push_back(run[k]);
  return value;
}

}  // namespace rosin::analysis::inference
