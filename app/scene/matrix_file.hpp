/// Square matrices: rows in the scene, or a file as finite-element programs and SciPy write them.
#pragma once
#include <Eigen/Core>
#include <filesystem>

#include "app/scene/scene_table.hpp"

namespace rosin::app::scene {

/// A list of rows; the name of a file; or { file, unit }. Files ending in .mtx are Matrix Market (coordinate or array,
/// general or symmetric), others are tables of numbers without names.
/// \param size of the matrices before it; 0: this is the first
/// \param folder in which files are looked for
/// \throws InputError with the file's line
Eigen::MatrixXd read_matrix(const toml::node&, const Quantity&, Eigen::Index size, const std::filesystem::path& folder);

}  // namespace rosin::app::scene
