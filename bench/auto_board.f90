! The slider under spinodal friction (Woodhouse, Putelat & McKay 2015, eqs 2.10-2.13) as a user of AUTO-07p writes it who
! knows its size: U = (k x/(N a), mu/a, ln psi), time in sqrt(m/k), parameters log10 of load, clock factor and speed.
SUBROUTINE FUNC(NDIM, U, ICP, PAR, IJAC, F, DFDU, DFDP)
  IMPLICIT NONE
  INTEGER, INTENT(IN) :: NDIM, ICP(*), IJAC
  DOUBLE PRECISION, INTENT(IN) :: U(NDIM), PAR(*)
  DOUBLE PRECISION, INTENT(OUT) :: F(NDIM)
  DOUBLE PRECISION, INTENT(INOUT) :: DFDU(NDIM, NDIM), DFDP(NDIM, *)
  DOUBLE PRECISION, PARAMETER :: k = 1.09D0, mu0 = 0.369D0, a = 0.0349D0, b = 0.0489D0, L = 0.9D-6, v0 = 1D-6, &
                                 c = 1D-3, heal = 90
  DOUBLE PRECISION :: N, V, kappa, psi, least, rate, w
  N = 10**PAR(1)
  V = 10**PAR(3)
  kappa = V*SQRT(k)/(N*a)
  psi = EXP(U(3))
  least = c*L/(L + v0*heal)
  rate = 2*v0*EXP(-(mu0 + b*LOG(c + psi*(L + v0*heal)/L))/a)
  w = rate*SINH(U(2))/V
  F(1) = kappa*(1 - w)
  F(3) = ((1/psi - 1)/heal - V*ABS(w)/L)/(10**PAR(2)*SQRT(k))
  F(2) = V*(U(1) - U(2))/(rate*COSH(U(2))*kappa) + TANH(U(2))*b/a*psi/(least + psi)*F(3)
END SUBROUTINE FUNC

SUBROUTINE STPNT(NDIM, U, PAR, T)
  IMPLICIT NONE
  INTEGER, INTENT(IN) :: NDIM
  DOUBLE PRECISION, INTENT(INOUT) :: U(NDIM), PAR(*)
  DOUBLE PRECISION, INTENT(IN) :: T
  DOUBLE PRECISION, PARAMETER :: mu0 = 0.369D0, a = 0.0349D0, b = 0.0489D0, L = 0.9D-6, v0 = 1D-6, c = 1D-3, heal = 90
  DOUBLE PRECISION :: psi, V
  PAR(1:3) = LOG10((/ START /)) ! load, clock factor, speed
  V = 10**PAR(3)
  psi = L/(L + V*heal)
  U(2) = ASINH(V/(2*v0)*EXP((mu0 + b*LOG(c + psi*(L + v0*heal)/L))/a))
  U(1) = U(2)
  U(3) = LOG(psi)
END SUBROUTINE STPNT

SUBROUTINE BCND
END SUBROUTINE BCND
SUBROUTINE ICND
END SUBROUTINE ICND
SUBROUTINE FOPT
END SUBROUTINE FOPT
SUBROUTINE PVLS
END SUBROUTINE PVLS
