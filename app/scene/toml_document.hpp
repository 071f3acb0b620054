/// A scene as a TOML document: read from its file, changed by `--set`, written as resolved.
#pragma once
#include <toml++/toml.h>

#include <string>
#include <string_view>
#include <vector>

#include "app/command_line.hpp"

namespace rosin::app::scene {

/// A scene's file as it stands there. \throws InputError with the line where it is empty, too large or no TOML.
toml::table read_toml(const std::string& path);
/// The same of a text; `origin` is what errors call it.
toml::table parse_toml(std::string_view text, const std::string& origin);
/// The scene of a request, from its file or text, after the overrides and with names of other programs as the scene's
/// own, which the notes say. \throws InputError
toml::table read_document(const Request&, std::vector<std::string>& notes);

/// Parses "path=value" and puts the value into the scene. \throws InputError with the override as its place.
void apply_override(toml::table& scene, const std::string& given);
/// The same of a number that a verb varies, which stands in no file. \throws InputError without a place
void set_number(toml::table& scene, const std::string& path, double number);

/// The path in full of one that is shortened as parameters of `map` and `branch` may be: "contacts.1.…" is in
/// "oscillator", "data.1.…" in "fit", and "drive.force.amplitude" that of the first harmonic.
std::string path_in_full(const toml::table& scene, const std::string& path);

/// What stands at a path, or nullptr. Entries of lists are numbered from 1, as in overrides.
const toml::node* node_at(const toml::table& scene, std::string_view path);

/// A text in which each {path} is replaced by the number or text that stands there, as a part of a file's name:
/// "{drive.speed}" is "1e-05". \throws InputError for a path with neither, with the nearest
std::string filled_in(const std::string& pattern, const toml::table& scene);

/// The scene as text, which is read back at once: values first, then a section for each table of the first level,
/// whose own tables stand on one line.
std::string resolved(const toml::table& scene);

}  // namespace rosin::app::scene
