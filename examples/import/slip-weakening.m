%% A block with mass whose friction falls over a distance of slip, in the names of EQcycle
Sn   = 20e6;          % normal stress, Pa
M    = 60e6;          % mass per unit area
K_s  = 1e6;           % stiffness per unit area
D_c  = 0.9796528896;  % m
mu_s = 0.7;
mu_d = 0.6;
V_0  = 1e-3;          % velocity of the load point
V_in = V_0;
u_0  = -mu_s*Sn/K_s;
tf   = 2147.5*pi*sqrt(M/K_s);
