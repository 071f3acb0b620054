/// A NetCDF-4 file. Nothing in it depends on when or where it was written.
#pragma once
#include <netcdf.h>
#include <netcdf_mem.h>

#include <string>
#include <string_view>
#include <vector>

#include "app/scene/scene.hpp"

namespace rosin::app::results {

/// A file being written in memory, because the HDF5 library does not survive a disk that fills up: definitions and
/// values in any order (NetCDF-4 needs no define mode).
class NetcdfFile {
 public:
  NetcdfFile();
  ~NetcdfFile();
  NetcdfFile(const NetcdfFile&) = delete;
  /// The attributes that every file of rosin has: title, version, and the scene as resolved.
  void begin(const scene::Scene&) const;
  /// The bytes of the file; they live as long as this object.
  std::string_view close();

  int dimension(const std::string& name, std::size_t length) const;
  int variable(const std::string& name, nc_type, const std::vector<int>& dimensions) const;
  void attribute(int variable, const char* name, const std::string& value) const;
  void attribute(int variable, const char* name, const std::vector<signed char>& values) const;
  void attribute(int variable, const char* name, int value) const;
  void attribute(int variable, const char* name, double value) const;
  void values(int variable, const std::vector<double>&) const;
  void values(int variable, const std::vector<signed char>&) const;
  void values(int variable, const std::vector<std::string>&) const;

 private:
  int file_ = 0;
  bool open_ = true;
  NC_memio image_{};
};

}  // namespace rosin::app::results
