// Fossen's MSS (MATLAB) calls a vehicle as xdot = vehicle(x, ui) with x = [u v w p q r x y z phi theta psi]': body
// forward-right-down, world north-east-down, as here. The file needs nothing but base MATLAB or Octave.
#include "common/exports/models/formats.hpp"

namespace fathom::exports {

ModelFile to_mss(const Craft& craft) {
  ModelFile file{.extension = "m", .text = {}, .unsaid = craft.notes};
  if (!craft.thrusters.empty()) file.unsaid.emplace_back("thrusters: the caller gives the wrench that they make");
  const auto list = [](const auto& values) { return "[" + exact(values, "; ") + "]"; };
  Vector6d rigid;
  rigid << craft.mass, craft.mass, craft.mass, craft.inertia;
  const Eigen::Vector3d restoring = -craft.buoyancy * craft.p_BB;
  const std::string name = identifier(craft.name);
  file.text = "function xdot = " + name + "(x, tau)\n% xdot = " + name + "(x, tau): " + craft.name +
              ", identified by fathom.\n% x = [u v w p q r x y z phi theta psi]' (m/s, rad/s, m, rad); tau = [X Y Z K "
              "M N]' (N, N m).\n"
              "% Body forward-right-down, world north-east-down.\n% Not said here:\n" +
              comment(file, "% - ") + "M_RB = diag(" + list(rigid) + ");\nM_A = diag(" + list(craft.added) +
              ");\nD_linear = " + list(craft.linear) +
              ";      % X_u .. N_r, negative\nD_quadratic = " + list(craft.quadratic) +
              ";   % X_u|u| .. N_r|r|\nW_B = " + exact(craft.weight - craft.buoyancy) +
              ";             % N, weight less buoyancy\nG = " + list(restoring) +
              ";               % N m: r_G W - r_B B\n"
              "nu = x(1:6);\nphi = x(10); theta = x(11); psi = x(12);\n"
              "R = [cos(psi)*cos(theta), -sin(psi)*cos(phi)+cos(psi)*sin(theta)*sin(phi), "
              "sin(psi)*sin(phi)+cos(psi)*cos(phi)*sin(theta)\n"
              "     sin(psi)*cos(theta), cos(psi)*cos(phi)+sin(phi)*sin(theta)*sin(psi), "
              "-cos(psi)*sin(phi)+sin(theta)*sin(psi)*cos(phi)\n"
              "     -sin(theta), cos(theta)*sin(phi), cos(theta)*cos(phi)];\n"
              "T = [1, sin(phi)*tan(theta), cos(phi)*tan(theta)\n     0, cos(phi), -sin(phi)\n     0, "
              "sin(phi)/cos(theta), cos(phi)/cos(theta)];\n"
              "M = M_RB + M_A;\nP = M(1:3,1:3) * nu(1:3);\nL = M(4:6,4:6) * nu(4:6);\n"
              "C_nu = [cross(nu(4:6), P); cross(nu(4:6), L) + cross(nu(1:3), P)];\n"
              "drag = (D_linear + D_quadratic .* abs(nu)) .* nu;\n"
              "down = R' * [0; 0; 1];\n"
              "nu_dot = M \\ (tau - C_nu + drag + [W_B * down; cross(G, down)]);\n"
              "xdot = [nu_dot; R * nu(1:3); T * nu(4:6)];\nend\n";
  return file;
}

}  // namespace fathom::exports
