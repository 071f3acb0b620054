/// Documents of results.
#include "app/results/result.hpp"

#include <span>

#include "app/results/writers.hpp"
#include "app/scene/scene.hpp"

namespace rosin::app::results {

void Object::add(const Channel& of, double value, double error) {
  add(of, ordered_json(value), std::isnan(error) && !std::isnan(value) ? ordered_json() : ordered_json(error));
}

void Object::add(const Channel& of, ordered_json list, ordered_json error) {
  values_[of.name] = std::move(list);
  describe(of, std::move(error));
}

void Object::describe(const Channel& of, ordered_json error) {
  if (!error.is_null()) error_[of.name] = std::move(error);
  if (!of.unit.empty()) units_[of.name] = of.unit;
  if (!of.meaning.empty()) meaning_[of.name] = of.meaning;
}

void Object::add_record(const Table& table) {
  const auto& first = table.columns.front();
  values_[first.of.name] = first.numbers();
  auto columns = ordered_json::object();
  for (const auto& column : std::span(table.columns).subspan(1)) {
    columns[column.of.name] = column.numbers();
    describe(column.of, column.error.size() == 1 ? ordered_json(column.error.front()) : nullptr);
  }
  values_["columns"] = std::move(columns);
}

ordered_json Object::json() const {
  auto all = values_;
  for (const auto& [key, about] : {std::pair{"error", &error_}, {"units", &units_}, {"meaning", &meaning_}})
    if (!about->is_null()) {
      auto& known = all[key];
      if (known.is_null()) known = ordered_json::object();
      known.update(*about);
    }
  return all;
}

ordered_json Object::entry() const {
  auto all = values_;
  if (!error_.is_null()) all["error"] = error_;
  return all;
}

Result::Result(const scene::Scene& scene, std::string verb, Outcome outcome)
    : scene(scene), outcome(std::move(outcome)), verb_(std::move(verb)) {}

ordered_json head(const scene::Scene& scene, const std::string& verb, const Outcome& outcome) {
  ordered_json document{{"title", scene.title}, {"verb", verb}};
  if (const auto& law = scene.model.law) {  // measured responses need none
    document["law"] = law->card().name;
    if (!law->approximation().empty()) document["approximation"] = law->approximation();
  }
  document["version"] = ROSIN_VERSION;
  document["schema"] = schema;
  document["outcome"] = name(outcome.ending);
  if (!outcome.detail.empty()) document["outcome_detail"] = outcome.detail;
  return document;
}

ordered_json Result::document() const {
  auto document = head(scene, verb_, outcome);
  document.update(json());
  auto& datasets = document["datasets"] = ordered_json::array();
  for (const auto& table : tables) datasets.push_back(description_of(table));
  if (!cost.is_null()) document["cost"] = cost;
  auto all = scene.notes;
  all.insert(all.end(), notes.begin(), notes.end());
  document["notes"] = all;
  return document;
}

ordered_json lists_of(const Table& table) {
  Object lists;
  for (const auto& column : table.columns)
    lists.add(column.of, column.numbers(), column.error.size() == 1 ? ordered_json(column.error.front()) : nullptr);
  return lists.entry();
}

ordered_json values(const std::vector<Quantity>& names, const std::vector<Value>& list) {
  auto object = ordered_json::object();
  for (std::size_t i = 0; i < names.size(); ++i)
    std::visit([&](const auto& value) { object[names[i].name] = value; }, list[i]);
  return object;
}

std::string text(const ordered_json& document) {
  return document.dump(1, ' ', false, ordered_json::error_handler_t::replace) + '\n';  // paths need not be UTF-8
}

ordered_json pair(std::complex<double> z) { return {z.real(), z.imag()}; }

ordered_json pairs(const std::vector<std::complex<double>>& list) {
  auto array = ordered_json::array();
  for (const auto& z : list) array.push_back(pair(z));
  return array;
}

}  // namespace rosin::app::results
