/// Matrices out of rows, tables, and the Matrix Market exchange format (Boisvert, Pozo and Remington 1996, NISTIR
/// 5935).
#include "app/scene/matrix_file.hpp"

#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <fstream>
#include <sstream>

#include "app/scene/table_cells.hpp"
#include "app/scene/table_file.hpp"
#include "core/error.hpp"

namespace rosin::app::scene {

namespace {

namespace fs = std::filesystem;
constexpr Eigen::Index most_coordinates = 4000;

/// One number in each row and column, where nothing else stands.
Eigen::MatrixXd read_table(const fs::path& path) {
  TableFile file(path, {});
  const auto& head = file.head();
  if (head.names_line > 0)
    throw InputError(
        fmt::format("{}:{}: names stand above the numbers; a matrix is numbers alone", path.string(), head.names_line));
  const auto n = Eigen::Index(head.columns.size());
  if (n > most_coordinates)
    throw InputError(fmt::format("{}: has {} columns; at most {} are read", path.string(), n, most_coordinates));
  for (Eigen::Index c = 0; c < n; ++c) file.need({"", "", "1", int(c) + 1});
  Eigen::MatrixXd matrix(n, n);
  Eigen::Index row = 0;
  for (std::vector<double> cells; file.row(cells); ++row) {
    for (Eigen::Index c = 0; c < n; ++c)
      if (std::isnan(cells[std::size_t(c)]))
        throw InputError(fmt::format("{}:{}: the number of column {} is missing", path.string(), file.line(), c + 1));
    if (row < n) matrix.row(row) = Eigen::Map<const Eigen::RowVectorXd>(cells.data(), n);
  }
  if (row != n) throw InputError(fmt::format("{}: is not square: {} rows of {} numbers", path.string(), row, n));
  return matrix;
}

/// Lines of a file in the Matrix Market format.
class MatrixMarket {
 public:
  explicit MatrixMarket(const fs::path& path) : path_(path.string()), file_(path) {
    if (!fs::is_regular_file(path) || !file_) throw InputError(fmt::format("{}: cannot be read", path_));
  }

  Eigen::MatrixXd matrix() {
    std::string mark, object;
    if (next()) std::istringstream(lower(line_)) >> mark >> object >> layout_ >> field_ >> symmetry_;
    if (mark != "%%matrixmarket" || object != "matrix" || (layout_ != "coordinate" && layout_ != "array"))
      refuse("is no head of a Matrix Market file, such as '%%MatrixMarket matrix coordinate real symmetric'");
    if (field_ != "real" && field_ != "integer" && field_ != "double")
      refuse(fmt::format("holds entries that are {}; real ones are needed", field_));
    if (symmetry_ != "general" && symmetry_ != "symmetric" && symmetry_ != "skew-symmetric")
      refuse(fmt::format("says '{}', where general, symmetric or skew-symmetric is needed", symmetry_));
    const bool listed = layout_ == "coordinate";
    const auto sizes = numbers(listed ? 3 : 2, "the size");
    const auto n = index(sizes[0], most_coordinates, "rows");
    if (index(sizes[1], most_coordinates, "columns") != n)
      refuse(fmt::format("is not square: {} rows, {} columns", sizes[0], sizes[1]));
    Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(n, n);
    if (listed) {
      const auto count = index(sizes[2], n * n, "entries");
      Eigen::Matrix<bool, Eigen::Dynamic, Eigen::Dynamic> given =
          Eigen::Matrix<bool, Eigen::Dynamic, Eigen::Dynamic>::Constant(n, n, false);
      for (Eigen::Index k = 0; k < count; ++k) {
        const auto entry = numbers(3, fmt::format("entry {} of {}", k + 1, count));
        const auto i = index(entry[0], n, "row") - 1, j = index(entry[1], n, "column") - 1;
        if (std::exchange(given(i, j), true)) refuse(fmt::format("gives the entry ({}, {}) again", i + 1, j + 1));
        put(matrix, i, j, entry[2]);
      }
    } else {
      for (Eigen::Index j = 0; j < n; ++j)
        for (Eigen::Index i = symmetry_ == "general" ? 0 : symmetry_ == "symmetric" ? j : j + 1; i < n; ++i)
          put(matrix, i, j, numbers(1, fmt::format("the entry ({}, {})", i + 1, j + 1))[0]);
    }
    while (next())
      if (!passed_over()) refuse("stands behind the last entry");
    return matrix;
  }

 private:
  [[noreturn]] void refuse(const std::string& why) const {
    throw InputError(fmt::format("{}:{}: {}", path_, number_, why));
  }
  bool next() {
    ++number_;
    return bool(std::getline(file_, line_));
  }
  bool passed_over() const { return trimmed(line_).empty() || trimmed(line_).front() == '%'; }

  std::vector<double> numbers(std::size_t count, const std::string& of) {
    do
      if (!next()) refuse(fmt::format("the file ends before {}", of));
    while (passed_over());
    std::vector<double> found;
    std::string_view rest = line_, cell;
    while (next_cell(rest, ' ', cell)) {
      double value = 0;
      if (read_number(cell, '.', value) != Kind::number)
        refuse(fmt::format("'{}' is no finite number", in_utf8(cell.substr(0, 40))));
      found.push_back(value);
    }
    if (found.size() != count) refuse(fmt::format("holds {} numbers, where {} takes {}", found.size(), of, count));
    return found;
  }
  Eigen::Index index(double value, Eigen::Index most, const char* of) const {
    const bool counts = std::string_view(of) == "entries";
    if (value != std::floor(value) || value < (counts ? 0 : 1) || value > double(most))
      refuse(fmt::format("{} = {} is not a whole number from {} to {}", of, value, counts ? 0 : 1, most));
    return Eigen::Index(value);
  }
  /// Of a symmetric matrix the lower triangle alone is stored.
  void put(Eigen::MatrixXd& matrix, Eigen::Index i, Eigen::Index j, double value) const {
    matrix(i, j) = value;
    if (symmetry_ == "general") return;
    if (i < j || (i == j && symmetry_ == "skew-symmetric"))
      refuse(fmt::format("the entry ({}, {}) is not below the diagonal, where a {} matrix is stored", i + 1, j + 1,
                         symmetry_));
    matrix(j, i) = symmetry_ == "symmetric" ? value : -value;
  }

  std::string path_;
  std::ifstream file_;
  std::string line_ = {}, layout_ = {}, field_ = {}, symmetry_ = {};
  long number_ = 0;
};

Eigen::MatrixXd read_rows(const toml::node& node, const Quantity& quantity) {
  const auto& rows = list(node, quantity.name, "rows, or the name of a file", most_names);
  const auto n = Eigen::Index(rows.size());
  Eigen::MatrixXd matrix(n, n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const auto& row = *rows.get(std::size_t(i));
    const auto values = numbers(row, quantity);
    if (Eigen::Index(values.size()) != n)
      fail(row.source(), "{} is not square: a row has {} of {}", quantity.name, values.size(), n);
    matrix.row(i) = Eigen::Map<const Eigen::RowVectorXd>(values.data(), n);
  }
  return matrix;
}

}  // namespace

Eigen::MatrixXd read_matrix(const toml::node& node, const Quantity& quantity, Eigen::Index size,
                            const fs::path& folder) {
  Eigen::MatrixXd matrix;
  if (node.is_string() || node.is_table()) {
    NumbersAsked::note(quantity);
    fs::path file;
    double unit = 1;
    if (node.is_table()) {
      Table table(node, quantity.name);
      table.expect({"file", "unit"});
      file = text(table.required("file", "the name of a file"), table.path("file"));
      if (const auto* given = table.find("unit"))
        unit = located(given->source(),
                       [&] { return Reference::to_si("1 " + text(*given, table.path("unit")), quantity.unit); });
      table.finish();
    } else {
      file = text(node, quantity.name);
    }
    if (!file.is_absolute()) file = folder / file;
    located(node.source(), [&] {
      matrix = lower(file.extension().string()) == ".mtx" ? MatrixMarket(file).matrix() : read_table(file);
      matrix *= unit;
      for (const double entry : matrix.reshaped())
        require(entry, quantity.range, quantity.name, quantity.meaning, quantity.unit);
    });
  } else {
    matrix = read_rows(node, quantity);
  }
  if (size > 0 && matrix.rows() != size)
    fail(node.source(), "{} has {} rows, but M has {}", quantity.name, matrix.rows(), size);
  return matrix;
}

}  // namespace rosin::app::scene
