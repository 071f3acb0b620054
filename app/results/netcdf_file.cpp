/// Writing with the NetCDF C interface.
#include "app/results/netcdf_file.hpp"

#include <fmt/format.h>

#include <cstdlib>
#include <stdexcept>

#include "app/scene/scene.hpp"

namespace rosin::app::results {

namespace {

void check(int status) {
  if (status != NC_NOERR) throw std::runtime_error(fmt::format("NetCDF: {}", nc_strerror(status)));
}

}  // namespace

NetcdfFile::NetcdfFile() { check(nc_create_mem("rosin.nc", NC_NETCDF4, 1 << 16, &file_)); }

NetcdfFile::~NetcdfFile() {
  if (open_) nc_abort(file_);
  std::free(image_.memory);
}

void NetcdfFile::begin(const scene::Scene& scene) const {
  attribute(NC_GLOBAL, "title", scene.title);
  attribute(NC_GLOBAL, "version", std::string("rosin ") + ROSIN_VERSION);
  attribute(NC_GLOBAL, "scene", scene.resolved);
}

std::string_view NetcdfFile::close() {
  open_ = false;
  check(nc_close_memio(file_, &image_));
  return {static_cast<const char*>(image_.memory), image_.size};
}

int NetcdfFile::dimension(const std::string& name, std::size_t length) const {
  int id;
  check(nc_def_dim(file_, name.c_str(), length, &id));
  return id;
}

int NetcdfFile::variable(const std::string& name, nc_type type, const std::vector<int>& dimensions) const {
  int id;
  check(nc_def_var(file_, name.c_str(), type, static_cast<int>(dimensions.size()), dimensions.data(), &id));
  return id;
}

void NetcdfFile::attribute(int variable, const char* name, const std::string& value) const {
  check(nc_put_att_text(file_, variable, name, value.size(), value.c_str()));
}

void NetcdfFile::attribute(int variable, const char* name, const std::vector<signed char>& values) const {
  check(nc_put_att_schar(file_, variable, name, NC_BYTE, values.size(), values.data()));
}

void NetcdfFile::attribute(int variable, const char* name, int value) const {
  check(nc_put_att_int(file_, variable, name, NC_INT, 1, &value));
}

void NetcdfFile::attribute(int variable, const char* name, double value) const {
  check(nc_put_att_double(file_, variable, name, NC_DOUBLE, 1, &value));
}

void NetcdfFile::values(int variable, const std::vector<double>& list) const {
  check(nc_put_var_double(file_, variable, list.data()));
}

void NetcdfFile::values(int variable, const std::vector<signed char>& list) const {
  check(nc_put_var_schar(file_, variable, list.data()));
}

void NetcdfFile::values(int variable, const std::vector<std::string>& list) const {
  std::vector<const char*> texts;
  for (const auto& text : list) texts.push_back(text.c_str());
  check(nc_put_var_string(file_, variable, texts.data()));
}

}  // namespace rosin::app::results
