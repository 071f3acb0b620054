% Stick-slip of a spring-slider that radiates, for the MATLAB wrapper of QDYN.
clear;
p = qdyn('set');
p.MESHDIM = 0;            % a spring-slider
p.MU = 2e10;  p.L = 10;   % stiffness MU/L
p.SIGMA = 5e6;
p.A = 0.01;  p.B = 0.025;  p.DC = 1e-5;
p.V_SS = 1e-6;            % the load point moves at it
p.TMAX = 1e4;
p.TH_0 = p.DC / p.V_SS;
[p, ot, ox] = qdyn('run', p, 'V_0', 1.01 * p.V_SS);
semilogy(ot.t, ot.v)
