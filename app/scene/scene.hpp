/// Scenes: what a user asks of a model, read from a TOML file and `--set` overrides, and checked before any work.
#pragma once
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "analysis/basins/basins.hpp"
#include "analysis/branches/branches.hpp"
#include "analysis/cycles/cycle.hpp"
#include "analysis/cycles/lyapunov.hpp"
#include "analysis/inference/discrimination.hpp"
#include "analysis/inference/equalise.hpp"
#include "analysis/inference/fit.hpp"
#include "analysis/lab/experiment.hpp"
#include "analysis/motion/plane_run.hpp"
#include "analysis/motion/run.hpp"
#include "analysis/motion/stepped_run.hpp"
#include "analysis/motion/structure_run.hpp"
#include "analysis/planes/map.hpp"
#include "analysis/planes/sweep.hpp"
#include "analysis/response/extraction.hpp"
#include "analysis/response/frf.hpp"
#include "analysis/response/frf_simulation.hpp"
#include "analysis/response/structure.hpp"
#include "analysis/strings/strings.hpp"
#include "analysis/studies/study.hpp"
#include "app/scene/record.hpp"
#include "oscillators/block.hpp"
#include "oscillators/model.hpp"

namespace rosin::app::scene {

/// The slip rates at which a steady curve is drawn, logarithmically spaced.
struct CurveOptions {
  double from = 1e-9, to = 1;  ///< m/s
  int points = 541;            ///< 60 a decade
  double normal_load = 1;      ///< N; the drive's, where the scene has one
};

/// Models side by side, and what is made equal in them beforehand.
struct CompareOptions {
  struct Member {
    std::string name;
    oscillators::Model model;
    std::vector<double> adjusted;  ///< values of the parameters that were adjusted
    double difference = 0;         ///< that is left of the properties made equal, relative
  };
  std::vector<Member> members;  ///< the first is the one that the others are compared with
  std::string protocol = "cycle";
  std::vector<std::string> adjust;  ///< paths of parameters
  std::vector<analysis::inference::Noise> noise;
  double confidence = 0.95;
  std::string parameter;  ///< of which a design asks; empty: it tells members apart
};

/// A measured record, and how a response is taken out of it.
struct FrfRecord {
  RecordSource source;        ///< columns in the order of the channels
  bool displacement = false;  ///< stands in the place of slip rate, which is made of it
  analysis::response::Channels channels;
  double resolution = 0;  ///< Hz
  analysis::response::WelchOptions welch;
  analysis::response::ExtractionOptions extraction;
};

/// A structure that a friction response is used on, and what is asked of both.
struct FrfUse {
  analysis::response::SlidingStructure sliding;
  /// Measured: at the same frequencies (Hz) where both are. Errors are of real and imaginary part each, or none.
  struct Measured {
    std::vector<double> frequency;
    std::vector<std::complex<double>> value;
    std::vector<double> error;
  };
  Measured friction, receptance;  ///< N s/m, m/N
  std::string scan;               ///< path of a parameter, or empty
  double scan_from = 0, scan_to = 0;
  int scan_points = 60;
  std::vector<analysis::response::Uncertain> uncertain;
  int samples = 400;
  std::uint64_t seed = 1;
};

/// Data, and the laws that are fitted to them.
struct FitTask {
  struct Candidate {
    std::string name;
    oscillators::Model model;
    std::vector<std::string> parameters;
  };
  std::vector<Candidate> candidates;  ///< the scene's own law first
  std::vector<analysis::inference::Measurement> data;
  analysis::inference::FitOptions options;
};

class Family;

/// A parameter along which the stability of a structure is followed.
struct StabilityScan {
  Quantity parameter;
  analysis::planes::Axis axis;
};

/// A parameter along which steady sliding and cycles are followed.
struct BranchTask {
  Quantity parameter;
  bool from_cycle = false;  ///< from the motion that has settled at the first value, else from steady sliding
  analysis::branches::BranchOptions options;
  /// A second parameter, in which the points where branches change are followed.
  struct Locus {
    Quantity parameter;
    double value = 0;  ///< of the scene
    analysis::branches::LocusOptions options;
  };
  std::optional<Locus> locus;
};

/// A coordinate, or the velocity of one, that starts differ in.
struct StartAxis {
  std::string name;
  int coordinate = 0;
  bool is_velocity = false;
  std::vector<double> values;  ///< of a grid, or the ends of the range of random starts
  const char* unit() const { return is_velocity ? "m/s" : "m"; }
};

/// Starts over a plane of two of their values, or disturbances of steady sliding.
struct BasinTask {
  StartAxis x, y;
  bool random = false;
  std::vector<std::pair<double, double>> places;        ///< of each start along x and y; of a grid in rows of y
  std::vector<std::pair<StartAxis, double>> direction;  ///< of disturbances
  analysis::basins::BasinTask task;
};

/// A bowed string, and what is asked of it.
struct StringTask {
  oscillators::BowedStringModel model;
  analysis::strings::BowingOptions options;
  int samples = 20'000;  ///< most that the record keeps
  analysis::planes::Axis x, y;
  analysis::strings::PlaneOptions plane;
  double good = 5;  ///< periods: transients that are shorter are good
  struct Member {
    std::string name;
    std::shared_ptr<const Family> family;
    std::vector<std::pair<std::string, double>> changed;  ///< numbers by their paths
  };
  std::vector<Member> members;  ///< of a comparison
};

struct Scene {
  std::string path;  ///< as the user gave it
  std::string title;
  oscillators::Model model;
  std::optional<analysis::motion::PlaneModel>
      plane;  ///< a slider in the plane, in place of the model's; for the verb run
  std::optional<analysis::motion::StructureModel> structure;  ///< in place of the model's slider
  std::optional<StringTask> string;                           ///< in place of the model's slider
  std::shared_ptr<const oscillators::BlockMesh> block;        ///< that the structure is the mesh of
  std::shared_ptr<const Family> family;                       ///< of it, where a number of the scene is varied
  CurveOptions curve;
  std::vector<std::string> hopf_parameters;  ///< paths asked for besides the usual ones
  int lowest_modes = 0;                      ///< of stability; 0: all
  std::optional<StabilityScan> stability_scan;
  BranchTask branch;
  analysis::motion::RunOptions run;
  analysis::cycles::CycleOptions cycle;
  analysis::planes::MapOptions map;
  analysis::planes::SweepOptions sweep;
  BasinTask basin;
  std::string sweep_column;  ///< whose values the result lists and the picture shows
  analysis::cycles::LyapunovOptions lyapunov;
  CompareOptions compare;
  analysis::studies::StudyOptions study;  ///< of the verb study, whose scenes have no model
  analysis::response::FrfOptions frf;
  bool frf_predicts = true;  ///< the scene has a drive to predict at
  std::optional<FrfRecord> frf_record;
  std::optional<FrfUse> frf_use;
  std::optional<analysis::response::SweepOptions> frf_sweep;
  std::optional<analysis::response::NoiseOptions> frf_noise;
  FitTask fit;
  const analysis::lab::Experiment* experiment = nullptr;  ///< only of the verb lab
  std::optional<analysis::lab::Task> lab;
  std::string resolved;                       ///< the scene as TOML, overrides included
  std::vector<std::string> notes;             ///< what was read but has no effect
  std::vector<std::string> files_read;        ///< what was understood of measured files
  std::uint64_t files_checksum = 0;           ///< of their numbers; 0: no file was read
  std::map<std::string, std::string> places;  ///< of keys by their paths: "scene.toml:7:5"

  /// The parameter at a path: of the family where there is one, else of the model.
  Quantity describe(const std::string& path) const;
  /// A refusal with the place of the first key that it names in front, or that of the key's table, or the file.
  std::string placed(const std::string& refusal) const;
};

}  // namespace rosin::app::scene
