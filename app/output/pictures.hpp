/// Pictures: gnuplot scripts beside the data of a results folder. The scripts stay, so that a user can restyle them.
#pragma once
#include <filesystem>
#include <span>
#include <string>
#include <vector>

namespace rosin::analysis::basins {
struct Basins;
}
namespace rosin::analysis::branches {
struct Branches;
struct Loci;
}  // namespace rosin::analysis::branches
namespace rosin::analysis::cycles {
struct IrregularMotion;
struct LyapunovSpectrum;
struct StructureCycle;
}  // namespace rosin::analysis::cycles
namespace rosin::analysis::inference {
struct Design;
}
namespace rosin::analysis::motion {
struct Frames;
struct MotionSpectrum;
struct Run;
}  // namespace rosin::analysis::motion
namespace rosin::analysis::planes {
struct Map;
struct Sweep;
}  // namespace rosin::analysis::planes
namespace rosin::analysis::steady {
struct Scan;
struct StructureStability;
}  // namespace rosin::analysis::steady
namespace rosin::analysis::strings {
struct Pixel;
struct StringRecord;
}  // namespace rosin::analysis::strings
namespace rosin::app::scene {
struct Scene;
}

namespace rosin::app::output {

struct Comparison;
struct Curve;

// Each writes a script and the data that only it needs into the folder, and returns the names of the files.
std::vector<std::string> write_picture(const std::filesystem::path& folder, const scene::Scene&, const Curve&);
std::vector<std::string> write_picture(const std::filesystem::path& folder, const scene::Scene&,
                                       const analysis::motion::Run&);
std::vector<std::string> write_picture(const std::filesystem::path& folder, const scene::Scene&,
                                       const analysis::motion::MotionSpectrum&);
std::vector<std::string> write_picture(const std::filesystem::path& folder, const scene::Scene&,
                                       const analysis::cycles::StructureCycle&);
std::vector<std::string> write_picture(const std::filesystem::path& folder, const scene::Scene&,
                                       const analysis::cycles::IrregularMotion&);
std::vector<std::string> write_picture(const std::filesystem::path& folder, const scene::Scene&,
                                       const analysis::steady::Scan&);
std::vector<std::string> write_picture(const std::filesystem::path& folder, const scene::Scene&,
                                       const analysis::branches::Branches&);
std::vector<std::string> write_picture(const std::filesystem::path& folder, const scene::Scene&,
                                       const analysis::branches::Loci&);
std::vector<std::string> write_picture(const std::filesystem::path& folder, const scene::Scene&,
                                       const analysis::cycles::LyapunovSpectrum&);
std::vector<std::string> write_picture(const std::filesystem::path& folder, const scene::Scene&,
                                       const analysis::planes::Map&);
std::vector<std::string> write_picture(const std::filesystem::path& folder, const scene::Scene&,
                                       const analysis::planes::Sweep&);
std::vector<std::string> write_picture(const std::filesystem::path& folder, const scene::Scene&,
                                       const analysis::basins::Basins&);
std::vector<std::string> write_picture(const std::filesystem::path& folder, const scene::Scene&, const Comparison&);
std::vector<std::string> write_picture(const std::filesystem::path& folder, const scene::Scene&,
                                       const analysis::inference::Design&);

/// Of an elastic block: steady sliding and its leading mode on the mesh; a motion with what sticks and what is open.
std::vector<std::string> write_block_picture(const std::filesystem::path& folder, const scene::Scene&,
                                             const analysis::steady::StructureStability&);
std::vector<std::string> write_block_picture(const std::filesystem::path& folder, const scene::Scene&,
                                             const analysis::motion::Run&);

/// Of the last oscillation of an elastic block, a drawing that moves: motion.svg.
std::vector<std::string> write_block_motion(const std::filesystem::path& folder, const scene::Scene&,
                                            const analysis::motion::Frames&);

/// Of a bowed string: what happens under the bow and at the bridge; a plane of transients, of regimes, or both.
std::vector<std::string> write_string_picture(const std::filesystem::path& folder, const scene::Scene&,
                                              const analysis::strings::StringRecord&);
std::vector<std::string> write_string_picture(const std::filesystem::path& folder, const scene::Scene&,
                                              std::span<const analysis::strings::Pixel>);
/// Planes of the members of a comparison side by side, and what the least different pair of them has between.
std::vector<std::string> write_string_picture(const std::filesystem::path& folder, const scene::Scene&,
                                              const std::vector<std::vector<analysis::strings::Pixel>>& planes,
                                              const std::vector<double>& separation);

}  // namespace rosin::app::output
