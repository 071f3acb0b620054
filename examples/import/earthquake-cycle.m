%% A block with mass and rate-and-state friction, in the names of EQcycle
clearvars; close all;

Sn   = 20e6;       % normal stress, Pa
M    = 60e6;       % mass per unit area
K_s  = 1e6;        % stiffness per unit area
L    = 0.09;
a    = 0.0144;
b    = 0.02312;
A    = a*Sn;
B    = b*Sn;
mu_d_rs = 0.64395; % friction at V_0
V_0  = 1e-3;       % velocity of the load point
V_in = V_0;
u_0  = -0.9*(mu_d_rs + b)*Sn/K_s;
tf   = 5637*L/V_0;

kappa = A*V_0/L;
y_in  = [13/kappa/(V_in/V_0)^(A/B) u_0/L V_in/V_0];
dy    = @(t, y) [1/kappa - y(3)*y(1); ...
                 y(3) - 1; ...
                 -K_s/M*(L/V_0)^2*(y(2) + (mu_d_rs*Sn + A*log(y(3)) + B*log(kappa*y(1)))/(K_s*L))];
[T, Y] = ode15s(dy, [0 tf/(L/V_0)], y_in);
