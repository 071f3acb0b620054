#include "app/scene/uncertain.hpp"

namespace rosin::app::scene {

std::vector<Uncertain> read_uncertain(Table& table, const std::function<void(const std::string& path)>& check,
                                      int& samples, std::uint64_t& seed) {
  std::vector<Uncertain> inputs;
  if (const auto* uncertain = table.find("uncertain")) {
    if (!uncertain->is_table()) wrong_kind(*uncertain, table.path("uncertain"), "a table such as { \"law.a\" = 0.1 }");
    for (const auto& [key, value] : *uncertain->as_table()) {
      const std::string path(key.str());
      located(value.source(), [&] { check(path); });
      inputs.push_back({path, number(value, {path, "1", {1e-9, 2}, "relative standard deviation"})});
    }
  }
  for (const char* key : {"samples", "seed"})
    if (const auto* given = inputs.empty() ? table.find(key) : nullptr)
      fail(given->source(), "{} has no effect without {}", table.path(key), table.path("uncertain"));
  table.read("samples", samples, 20, 1'000'000, "of uncertain inputs");
  int number_of_seed = 1;
  table.read("seed", number_of_seed, 0, largest_seed, "of the random numbers");
  seed = std::uint64_t(number_of_seed);
  return inputs;
}

}  // namespace rosin::app::scene
