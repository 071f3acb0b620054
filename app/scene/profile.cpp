/// Profiles as waves, rough tracks, or measured heights.
#include "app/scene/profile.hpp"

#include <cmath>

namespace rosin::app::scene {

using oscillators::most_waves;
using oscillators::Profile;

namespace {

constexpr Range length{1e-9, 1e6}, height{0, 1};

void read_wave(Table& table, Profile& profile) {
  Profile::Wave wave{0, 1, 0};
  table.required("amplitude", "m");
  table.required("wavelength", "m");
  table.read("amplitude", wave.amplitude, {"", "m", height, "amplitude of a profile"});
  table.read("wavelength", wave.wavelength, {"", "m", length, "wavelength of a profile"});
  table.read("phase", wave.phase, {"", "rad", {-1e6, 1e6}, "phase of a wave of the profile, at distance 0"});
  profile.waves.push_back(wave);
}

Profile read_waves(Table& table) {
  Profile profile;
  const auto& waves = table.required("waves", "tables { amplitude, wavelength, phase }");
  int number = 0;
  for (const auto& element : list(waves, table.path("waves"), "tables", most_waves)) {
    Table wave(element, fmt::format("{}.{}", table.path("waves"), ++number));
    wave.expect({"amplitude", "wavelength", "phase"});
    read_wave(wave, profile);
    wave.finish();
  }
  if (profile.waves.empty()) fail(waves.source(), "{} is empty: a profile has one wave or more", table.path("waves"));
  return profile;
}

Profile read_rough_track(Table& table) {
  oscillators::RoughTrack track;
  table.required("rms", "root mean square of the height, m");
  const auto& shortest = table.required("shortest", "wavelength, m");
  table.required("longest", "wavelength, m");
  table.read("rms", track.rms, {"", "m", height, "root mean square of a profile"});
  table.read("shortest", track.shortest, {"", "m", length, "shortest wavelength of a profile"});
  table.read("longest", track.longest, {"", "m", length, "longest wavelength of a profile"});
  track.length = track.longest;
  table.read("length", track.length, {"", "m", length, "length after which a track closes"});
  table.read("hurst", track.hurst, {"", "1", {-1, 1}, "Hurst exponent of a profile"});
  int seed = 1;
  table.read("seed", seed, 0, largest_seed, "of the random phases");
  track.seed = std::uint64_t(seed);
  return located(shortest.source(), [&] { return oscillators::profile_of(track); });
}

/// Heights at equal spacing, once round the track.
Profile read_heights(Table& table, const std::filesystem::path& folder) {
  const auto& node = table.required("table", "a file of distances and heights, m");
  const std::string path = table.path("table");
  RecordSource source;
  RecordColumn distance{"", "", "m", 1}, heights{"", "", "m", 2};
  bool chosen = false;
  if (node.is_table()) {
    Table keys(node, path);
    keys.expect({"file", "names_line", "decimal", "distance", "height"});
    source = read_file(keys, folder);
    const auto *of_distance = keys.find("distance"), *of_height = keys.find("height");
    if (of_distance) distance = read_column(*of_distance, keys.path("distance"), "m");
    if (of_height) heights = read_column(*of_height, keys.path("height"), "m");
    chosen = of_distance && of_height;
    keys.finish();
  } else {
    const std::filesystem::path file = text(node, path);
    source.file = file.is_absolute() ? file : folder / file;
  }
  source.columns = {std::move(distance), std::move(heights)};
  source.least = 3;
  if (!chosen) source.width = 2;
  return located(node.source(), [&] {
    std::vector<double> place, level;
    read_record(source, [&](double, std::span<const std::span<const double>> block) {
      place.insert(place.end(), block[0].begin(), block[0].end());
      level.insert(level.end(), block[1].begin(), block[1].end());
      if (place.size() > 2 * std::size_t(most_waves))
        throw InputError(fmt::format("{}: has more than {} rows; a profile is a sum of at most {} waves",
                                     source.file.string(), 2 * most_waves, most_waves));
    });
    const double spacing = (place.back() - place.front()) / double(place.size() - 1);
    constexpr double even = 1e-3;
    for (std::size_t i = 1; i < place.size(); ++i)
      if (const double step = place[i] - place[i - 1]; !(std::abs(step - spacing) <= even * spacing))
        throw InputError(fmt::format(
            "{}: distances must ascend at equal spacing, once round the track, but {:.6g} m follows {:.6g} m where "
            "{:.6g} m is the mean spacing",
            source.file.string(), place[i], place[i - 1], spacing));
    for (const double value : level)
      if (std::abs(value) > height.high)
        throw InputError(fmt::format("{}: a height of {:.6g} m is outside {} … {} m", source.file.string(), value,
                                     -height.high, height.high));
    return oscillators::profile_of(level, spacing);
  });
}

}  // namespace

std::optional<Profile> read_profile(SceneReader& reader, Table& owner) {
  auto table = owner.table("profile");
  if (!table) return std::nullopt;
  const auto type = choice(table->required("type", "harmonic, harmonics, random or table"), table->path("type"),
                           {"harmonic", "harmonics", "random", "table"});
  Profile profile;
  if (type == "harmonic") {
    table->expect({"amplitude", "wavelength", "phase"});
    read_wave(*table, profile);
  } else if (type == "harmonics") {
    table->expect({"waves"});
    profile = read_waves(*table);
  } else if (type == "random") {
    table->expect({"rms", "shortest", "longest", "length", "hurst", "seed"});
    profile = read_rough_track(*table);
  } else {
    table->expect({"table"});
    profile = read_heights(*table, reader.folder);
  }
  table->finish();
  return profile;
}

void read_profile_under(SceneReader& reader, Table& owner, oscillators::FrictionContact& contact) {
  if (contact.normal.size() == 0) return refuse_profile(owner);
  const auto profile = read_profile(reader, owner);
  if (!profile) return;
  contact.normal_law = located(owner.find("profile")->source(), [&] {
    return std::make_shared<oscillators::OverProfile>(contact.normal_law, *profile, contact.speed);
  });
}

void refuse_profile(Table& owner) {
  if (const auto* profile = owner.find("profile"))
    fail(
        profile->source(),
        "{} has no effect: the load of this contact is prescribed, and has no stiffness by which a height could change "
        "it; a profile goes under a contact that gives way along its normal, of type 'structure' (normal and "
        "normal_contact), 'mode-coupling' or 'pin-on-disk'",
        owner.path("profile"));
}

}  // namespace rosin::app::scene
