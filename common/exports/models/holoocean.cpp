// A Python module for HoloOcean's custom dynamics (byu-holoocean.github.io: "Manually Defining Dynamics", "Dynamics
// sensor"): the simulator integrates linear and angular accelerations in its world, north-west-up, and applies nothing
// else; the sensor tells a v p, alpha omega quaternion (x y z w), all in that world.
#include "common/exports/models/formats.hpp"
#include "common/exports/models/python_model.hpp"

namespace fathom::exports {

std::string python_model(const Craft& craft) {
  const auto list = [](const auto& values) { return "numpy.array([" + exact(values, ", ") + "])"; };
  Vector6d rigid;
  rigid << craft.mass, craft.mass, craft.mass, craft.inertia;
  const Eigen::Vector3d restoring = -craft.buoyancy * craft.p_BB;
  return "RIGID = " + list(rigid) + "  # kg, kg m^2\nADDED = " + list(craft.added) +
         "\nLINEAR = " + list(craft.linear) + "  # X_u .. N_r, negative\nQUADRATIC = " + list(craft.quadratic) +
         "  # X_u|u| .. N_r|r|\nW_B = " + exact(craft.weight - craft.buoyancy) +
         "  # N, weight less buoyancy\nG = " + list(restoring) +
         "  # N m: r_G W - r_B B\n\n\n"
         "def body_acceleration(R, nu, tau):\n"
         "    \"\"\"nu_dot of u v w p q r, forward-right-down. R: body to north-east-down; tau: N, N m, at the "
         "origin.\"\"\"\n"
         "    M = RIGID + ADDED\n"
         "    v, w = nu[:3], nu[3:]\n"
         "    P, L = M[:3] * v, M[3:] * w\n"
         "    coriolis = numpy.concatenate([numpy.cross(w, P), numpy.cross(w, L) + numpy.cross(v, P)])\n"
         "    drag = (LINEAR + QUADRATIC * numpy.abs(nu)) * nu\n"
         "    down = R.T @ numpy.array([0.0, 0.0, 1.0])\n"
         "    restoring = numpy.concatenate([W_B * down, numpy.cross(G, down)])\n"
         "    return (tau - coriolis + drag + restoring) / M\n";
}

ModelFile to_holoocean(const Craft& craft) {
  ModelFile file{.extension = "py", .text = {}, .unsaid = craft.notes};
  if (!craft.thrusters.empty()) file.unsaid.emplace_back("thrusters: the caller gives the wrench that they make");
  file.text =
      "\"\"\"" + craft.name +
      ", identified by fathom, for HoloOcean's custom dynamics. Needs numpy.\n\n"
      "    state = env.tick()[\"DynamicsSensor\"]     # \"UseRPY\": False, \"UseCOM\": True\n"
      "    env.act(\"auv0\", accelerations(state, tau))   # tau: N, N m, forward-right-down\n\nNot said here:\n" +
      comment(file, "- ") + "\"\"\"\n\nimport numpy\n\n" + python_model(craft) +
      "\n\nFLIP = numpy.diag([1.0, -1.0, -1.0])  # north-east-down and north-west-up; forward-right-down and "
      "-left-up\n\n\n"
      "def rotation(q):\n"
      "    x, y, z, w = q\n"
      "    return numpy.array([[1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],\n"
      "                        [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],\n"
      "                        [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)]])\n\n\n"
      "def accelerations(state, tau):\n"
      "    \"\"\"Linear and angular acceleration in HoloOcean's world, of a state of its DynamicsSensor.\"\"\"\n"
      "    state = numpy.asarray(state, dtype=float)\n"
      "    R = FLIP @ rotation(state[15:19]) @ FLIP\n"
      "    v, w = FLIP @ state[3:6], FLIP @ state[12:15]\n"
      "    nu = numpy.concatenate([R.T @ v, R.T @ w])\n"
      "    nu_dot = body_acceleration(R, nu, numpy.asarray(tau, dtype=float))\n"
      "    linear = R @ (nu_dot[:3] + numpy.cross(nu[3:], nu[:3]))  # the turning body's axes carry the velocity "
      "along\n"
      "    return numpy.concatenate([FLIP @ linear, FLIP @ (R @ nu_dot[3:])])\n";
  return file;
}

}  // namespace fathom::exports
