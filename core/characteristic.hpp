/// Roots of det(J − s M) = 0 for small systems whose rates span many decades, each with its own error.
///
/// QR loses eigenvalues smaller than 1e-16 of the largest in rounding. The coefficients of the characteristic
/// polynomial lose only what truly cancels, and so do its roots, whatever their spread.
#pragma once
#include <complex>
#include <span>
#include <vector>

namespace rosin {

struct CharacteristicRoots {
  std::vector<std::complex<double>> values;
  /// Absolute errors of the roots, and of their real parts alone, for entries of J and M known to 4e-15 of their size.
  std::vector<double> errors, real_errors;
};

/// \param jacobian row-major n × n. \param mass diagonal of M; zero rows are algebraic and lower the degree.
/// \param sizes of the entries of J, which are known to 4e-15 of these; their own magnitudes if empty.
/// NaN throughout where an entry is not finite. Costs 2ⁿ n² where no entry is 0.
CharacteristicRoots characteristic_roots(std::span<const double> jacobian, std::span<const double> mass,
                                         std::span<const double> sizes = {});
/// Roots of det(A − s E) = 0, E of any form; all row-major n × n. \param A_sizes, E_sizes what each entry was summed
/// from.
CharacteristicRoots pencil_roots(std::span<const double> A, std::span<const double> E, std::span<const double> A_sizes,
                                 std::span<const double> E_sizes);
/// Unknowns beyond which a determinant is too dear to expand.
inline constexpr std::size_t most_expanded = 14;
/// The part of their sizes that entries are known to.
inline constexpr double entry_rounding = 4e-15;

}  // namespace rosin
