/// Kernels and decompositions of Eigen that many files use, compiled once, in eigen_instances.cpp: every file that
/// solves a system would compile them again. Precompiled with rosin's own files, so that no header of rosin needs it.
#pragma once

#include <Eigen/Dense>
#include <Eigen/SparseLU>
#include <complex>

#ifndef ROSIN_EIGEN_INSTANCE
#define ROSIN_EIGEN_INSTANCE extern template
#endif

namespace rosin {
struct EigenInstances {
  using Real = Eigen::internal::gebp_traits<double, double>;
  using Complex = Eigen::internal::gebp_traits<std::complex<double>, std::complex<double>>;
  using Columns = Eigen::Block<Eigen::MatrixXd, Eigen::Dynamic, Eigen::Dynamic, false>;
  using Column = Eigen::Block<const Eigen::MatrixXd, Eigen::Dynamic, 1, false>;
  using PartOfColumn = Eigen::VectorBlock<Eigen::Block<Eigen::MatrixXd, Eigen::Dynamic, 1, true>, Eigen::Dynamic>;
};
}  // namespace rosin

#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wignored-attributes"  // alignment of Packet2d as an argument

namespace Eigen {

namespace internal {

// Products of matrices.
ROSIN_EIGEN_INSTANCE struct gebp_kernel<double, double, Index, blas_data_mapper<double, Index, ColMajor>,
                                        rosin::EigenInstances::Real::mr, rosin::EigenInstances::Real::nr>;
ROSIN_EIGEN_INSTANCE struct gebp_kernel<std::complex<double>, std::complex<double>, Index,
                                        blas_data_mapper<std::complex<double>, Index, ColMajor>,
                                        rosin::EigenInstances::Complex::mr, rosin::EigenInstances::Complex::nr>;
ROSIN_EIGEN_INSTANCE void evaluateProductBlockingSizesHeuristic<double, double, 1, Index>(Index&, Index&, Index&,
                                                                                          Index);
ROSIN_EIGEN_INSTANCE void evaluateProductBlockingSizesHeuristic<double, double, 4, Index>(Index&, Index&, Index&,
                                                                                          Index);
ROSIN_EIGEN_INSTANCE struct general_matrix_matrix_product<Index, double, ColMajor, false, double, ColMajor, false,
                                                          ColMajor, 1>;
ROSIN_EIGEN_INSTANCE struct general_matrix_matrix_product<Index, double, RowMajor, false, double, ColMajor, false,
                                                          ColMajor, 1>;
ROSIN_EIGEN_INSTANCE struct general_matrix_matrix_product<Index, std::complex<double>, ColMajor, false,
                                                          std::complex<double>, ColMajor, false, ColMajor, 1>;
ROSIN_EIGEN_INSTANCE struct gemm_pack_lhs<double, Index, const_blas_data_mapper<double, Index, ColMajor>,
                                          rosin::EigenInstances::Real::mr, rosin::EigenInstances::Real::LhsProgress,
                                          rosin::EigenInstances::Real::LhsPacket4Packing, ColMajor>;
ROSIN_EIGEN_INSTANCE struct gemm_pack_lhs<double, Index, const_blas_data_mapper<double, Index, RowMajor>,
                                          rosin::EigenInstances::Real::mr, rosin::EigenInstances::Real::LhsProgress,
                                          rosin::EigenInstances::Real::LhsPacket4Packing, RowMajor>;
ROSIN_EIGEN_INSTANCE struct gemm_pack_rhs<double, Index, const_blas_data_mapper<double, Index, ColMajor>,
                                          rosin::EigenInstances::Real::nr, ColMajor>;
ROSIN_EIGEN_INSTANCE struct gemm_pack_rhs<double, Index, blas_data_mapper<double, Index, ColMajor>,
                                          rosin::EigenInstances::Real::nr, ColMajor, false, true>;

// Products of a matrix and a vector.
#define ROSIN_PRODUCT(Number, A, x, Version)                                                                         \
  ROSIN_EIGEN_INSTANCE struct general_matrix_vector_product<Index, Number, const_blas_data_mapper<Number, Index, A>, \
                                                            A, false, Number,                                        \
                                                            const_blas_data_mapper<Number, Index, x>, false, Version>;
ROSIN_PRODUCT(double, RowMajor, ColMajor, 0)
ROSIN_PRODUCT(double, RowMajor, RowMajor, 0)
ROSIN_PRODUCT(double, RowMajor, RowMajor, 1)
ROSIN_PRODUCT(double, ColMajor, RowMajor, 0)
ROSIN_PRODUCT(double, ColMajor, ColMajor, 0)
ROSIN_PRODUCT(std::complex<double>, RowMajor, ColMajor, 0)
ROSIN_PRODUCT(std::complex<double>, ColMajor, RowMajor, 0)
ROSIN_PRODUCT(std::complex<double>, ColMajor, ColMajor, 0)
#undef ROSIN_PRODUCT

// Triangles.
ROSIN_EIGEN_INSTANCE struct triangular_solve_matrix<double, Index, OnTheLeft, UnitLower, false, ColMajor, ColMajor, 1>;
ROSIN_EIGEN_INSTANCE struct triangular_solve_matrix<double, Index, OnTheLeft, Upper, false, ColMajor, ColMajor, 1>;
ROSIN_EIGEN_INSTANCE struct triangular_solve_matrix<std::complex<double>, Index, OnTheLeft, UnitLower, false, ColMajor,
                                                    ColMajor, 1>;
ROSIN_EIGEN_INSTANCE struct triangular_solve_matrix<std::complex<double>, Index, OnTheLeft, Upper, false, ColMajor,
                                                    ColMajor, 1>;
ROSIN_EIGEN_INSTANCE struct triangular_solve_vector<double, double, Index, OnTheLeft, UnitLower, false, ColMajor>;
ROSIN_EIGEN_INSTANCE struct triangular_solve_vector<double, double, Index, OnTheLeft, Upper, false, ColMajor>;
ROSIN_EIGEN_INSTANCE struct product_triangular_matrix_matrix<double, Index, Lower, true, ColMajor, false, ColMajor,
                                                             false, ColMajor, 1>;
ROSIN_EIGEN_INSTANCE struct product_triangular_matrix_matrix<double, Index, UnitLower, true, ColMajor, false, ColMajor,
                                                             false, ColMajor, 1>;
ROSIN_EIGEN_INSTANCE struct product_triangular_matrix_matrix<double, Index, Upper, true, RowMajor, false, ColMajor,
                                                             false, ColMajor, 1>;
ROSIN_EIGEN_INSTANCE struct product_triangular_matrix_matrix<double, Index, UnitUpper, true, RowMajor, false, ColMajor,
                                                             false, ColMajor, 1>;

ROSIN_EIGEN_INSTANCE struct partial_lu_impl<double, ColMajor, int>;
ROSIN_EIGEN_INSTANCE struct partial_lu_impl<std::complex<double>, ColMajor, int>;

// Reflections.
ROSIN_EIGEN_INSTANCE void make_block_householder_triangular_factor(Matrix<double, Dynamic, Dynamic, RowMajor>&,
                                                                   const rosin::EigenInstances::Columns&,
                                                                   const VectorBlock<const VectorXd>&);
ROSIN_EIGEN_INSTANCE void make_block_householder_triangular_factor(Matrix<double, Dynamic, Dynamic, RowMajor>&,
                                                                   const rosin::EigenInstances::Columns&,
                                                                   const Block<const VectorXd, Dynamic, 1, false>&);
ROSIN_EIGEN_INSTANCE void apply_block_householder_on_the_left(rosin::EigenInstances::Columns&,
                                                              const rosin::EigenInstances::Columns&,
                                                              const VectorBlock<const VectorXd>&, bool);

}  // namespace internal

ROSIN_EIGEN_INSTANCE void MatrixBase<rosin::EigenInstances::Columns>::applyHouseholderOnTheLeft(
    const rosin::EigenInstances::Column&, const double&, double*);
ROSIN_EIGEN_INSTANCE void MatrixBase<rosin::EigenInstances::Columns>::applyHouseholderOnTheLeft(
    const rosin::EigenInstances::PartOfColumn&, const double&, double*);
ROSIN_EIGEN_INSTANCE void MatrixBase<rosin::EigenInstances::Columns>::applyHouseholderOnTheRight(
    const rosin::EigenInstances::Column&, const double&, double*);
ROSIN_EIGEN_INSTANCE void HouseholderSequence<MatrixXd, VectorXd>::evalTo(MatrixXd&, VectorXd&) const;
ROSIN_EIGEN_INSTANCE void HouseholderSequence<MatrixXd, VectorXd>::applyThisOnTheLeft(MatrixXd&, VectorXd&, bool) const;

ROSIN_EIGEN_INSTANCE class PartialPivLU<MatrixXd>;
ROSIN_EIGEN_INSTANCE class PartialPivLU<MatrixXcd>;
ROSIN_EIGEN_INSTANCE PartialPivLU<MatrixXd>::PartialPivLU(const EigenBase<MatrixXd>&);
ROSIN_EIGEN_INSTANCE PartialPivLU<MatrixXcd>::PartialPivLU(const EigenBase<MatrixXcd>&);
ROSIN_EIGEN_INSTANCE class FullPivLU<MatrixXd>;
ROSIN_EIGEN_INSTANCE class HouseholderQR<MatrixXd>;
ROSIN_EIGEN_INSTANCE class ColPivHouseholderQR<MatrixXd>;
ROSIN_EIGEN_INSTANCE class CompleteOrthogonalDecomposition<MatrixXd>;
ROSIN_EIGEN_INSTANCE SelfAdjointEigenSolver<MatrixXd>& SelfAdjointEigenSolver<MatrixXd>::compute(
    const EigenBase<MatrixXd>&, int);
ROSIN_EIGEN_INSTANCE class SparseLU<SparseMatrix<double>>;

}  // namespace Eigen

#pragma GCC diagnostic pop
