/// The command line of `rosin`.
#pragma once
#include <cstdint>
#include <optional>
#include <set>
#include <string>
#include <variant>
#include <vector>

namespace rosin::app {

namespace verbs {
class Ranks;
}

/// What the user asked for.
struct Request {
  std::string verb;                 ///< "laws", "curve", …
  std::string experiment;           ///< of "lab"
  std::optional<std::string> text;  ///< the scene itself, where it stands in no file; `target` then names it
  std::string target;  ///< scene file; a law's name for "laws"; a folder or scene for "plot"; "cycle", … for "bench"
  std::string as;      ///< import, export: the other program's format; empty: what the file looks like
  std::vector<std::string> cases;  ///< of "verify": names of cases or groups, or files; empty: all
  std::string dossier;             ///< verify: the folder of cases; empty: that of this installation
  std::vector<std::string> overrides;
  std::optional<double> tolerance;
  std::optional<double> time_limit;  ///< s, for all that the verb does
  int threads = 1;
  std::uint64_t seed = 1;  ///< of "stress": its first random scenes, or one of them
  long scenes = 1000, only = -1;
  bool draw = false;  ///< stress: write the scenes, judge none
  std::string out;
  bool json = false, explain = false, quiet = false;
  bool no_pictures = false;                 ///< scripts are written, not drawn
  std::set<std::string> formats;            ///< in which tables are written beside CSV: "netcdf", those of results/
  bool pdf = false;                         ///< pictures are drawn as PDF, too
  std::optional<double> width;              ///< mm, of pictures in print; none: as on a screen
  bool design = false;                      ///< compare: where measurements would tell members apart
  bool exact = false;                       ///< map: compute every point
  std::string shard;                        ///< map: "2/8", the share of the plane; empty: all, or a SLURM array's
  std::vector<std::string> from;            ///< merge: folders or files of journals
  bool forecast = false;                    ///< merge: say what the plane takes on many processes
  verbs::Ranks* ranks = nullptr;            ///< the processes of one launcher; none: this one alone
  bool quick = false;                       ///< bench: only check that everything works; verify: leave slow cases out
  std::string python = "/usr/bin/python3";  ///< bench: the Python that has SciPy
  double limit = 60;                        ///< bench: seconds for all tolerances of one solver
};

/// An argument or option of a verb, as pages and completions show it.
struct ArgumentUsage {
  std::string name;   ///< "SCENE", "--set"
  std::string value;  ///< kind of its value, "TEXT"; empty for a flag
  std::string help;
  bool required;
  std::vector<std::string> choices;  ///< the names it is one of; empty: anything
};
struct VerbUsage {
  std::string name, help;
  std::vector<ArgumentUsage> arguments, options;
};
/// Every verb, as the command line is parsed.
std::vector<VerbUsage> verb_usages();

/// The request, or the exit status where everything is said already (--help, --version, wrong usage).
std::variant<Request, int> parse_command_line(int argc, char** argv);

/// What 'rosin help' says of a verb, or of all. \throws InputError for a name that is none.
std::string help_of(const std::string& verb);

}  // namespace rosin::app
