/// Receptance of structures with sliding friction in them: one coordinate against the slider's frequency response, two
/// against closed forms.
#include "analysis/response/sliding_receptance.hpp"

#include <Eigen/LU>
#include <catch2/catch.hpp>
#include <cmath>

#include "analysis/response/frf.hpp"
#include "laws/catalogue.hpp"
#include "laws/normal_law.hpp"
#include "tests/bristol_board.hpp"

using namespace rosin;
using namespace rosin::analysis::response;
using Catch::Matchers::Contains;
using oscillators::Model;
using oscillators::Structure;
using Complex = std::complex<double>;

namespace {

constexpr double a = 0.010, b = 0.015, L = 1e-5, V = 1e-4;

Model ageing(double load) { return tests::slider_under("ageing", {0.6, a, b, L, 1e-6}, {2, 1500, 3}, V, load); }

/// δF/δv of the ageing law in closed form: N/V (a s + (a − b) V/L)/(s + V/L), for μ far above a.
Complex response_of_ageing(double load, Complex s) { return load / V * (a * s + (a - b) * V / L) / (s + V / L); }

/// Two blocks under the ageing law, the second with 0.8 of the load.
Structure two_blocks(double load) {
  auto contact = oscillators::contact_of(ageing(load));
  auto structure = oscillators::chain({.mass = {1, 0.8},
                                       .coupling_stiffness = {600},
                                       .coupling_damping = {2},
                                       .pull_stiffness = {1200, 900},
                                       .pull_damping = {1, 0}},
                                      {contact, contact});
  structure.contacts[1].load_factor = 0.8;
  return structure;
}

}  // namespace

TEST_CASE("the receptance of one coordinate is that of a slider closed with its friction response", "[frf]") {
  for (const auto* law : {"ageing", "slip", "spinodal", "stribeck"}) {
    auto model = ageing(5);
    model.law = laws::find_law(law);
    model.lambda = 3;
    CAPTURE(law);
    const FrictionResponse response(model);
    const auto structure = oscillators::one_slider(model);
    const auto receptance = sliding_receptance(structure, 0);
    const FrictionResponse of_contact(contact_in_sliding(structure, 0));
    for (const double omega : {0.01, 1.0, 20.0, 27.4, 300.0, 1e5}) {
      CAPTURE(omega);
      const Complex s(0, omega);
      const auto [mass, stiffness, damping] = model.slider;
      const Complex Z = response.tangential(s), expected = 1.0 / (mass * s * s + (damping + Z) * s + stiffness);
      const auto answer = receptance.at(s);
      CHECK(std::abs(answer.contact - expected) <= answer.contact_error);
      CHECK(answer.contact_error <= 1e-9 * std::abs(expected));
      CHECK(answer.coordinates[0] == answer.contact);
      CHECK(std::abs(of_contact.tangential(s) - Z) <= 1e-13 * std::abs(Z));
    }
  }
}

TEST_CASE("two blocks under the ageing law have the receptance of their closed form", "[frf]") {
  constexpr double load = 4;
  const auto structure = two_blocks(load);
  for (const int contact : {0, 1}) {
    const auto receptance = sliding_receptance(structure, contact);
    CHECK(contact_in_sliding(structure, contact).drive.normal_load.level() ==
          Approx(contact == 0 ? load : 0.8 * load).epsilon(1e-14));
    for (const double omega : {0.1, 3.0, 30.0, 44.7, 300.0}) {
      CAPTURE(contact, omega);
      const Complex s(0, omega);
      Eigen::Matrix2cd D;
      D << s * s + 3.0 * s + 1800.0, -2.0 * s - 600.0, -2.0 * s - 600.0, 0.8 * s * s + 2.0 * s + 1500.0;
      D(0, 0) += s * response_of_ageing(load, s), D(1, 1) += s * response_of_ageing(0.8 * load, s);
      const Eigen::Vector2cd expected = D.inverse().col(contact);
      const auto answer = receptance.at(s);
      for (const int i : {0, 1}) {
        CHECK(std::abs(answer.coordinates[std::size_t(i)] - expected[i]) <= answer.errors[std::size_t(i)]);
        CHECK(answer.errors[std::size_t(i)] <= 1e-9 * expected.norm());
      }
      CHECK(answer.contact == answer.coordinates[std::size_t(contact)]);
    }
  }
}

TEST_CASE("friction under a load that follows motion makes the receptance of a structure unsymmetrical", "[frf]") {
  constexpr double mu = 0.6, k_n = 11;
  Model model;
  model.law = laws::find_law("coulomb")->with({2.0, mu});
  model.drive.speed = 1.0, model.drive.normal_load = 10.0;
  laws::LinearContact normal;
  normal.stiffness = k_n;
  const auto structure = oscillators::mode_coupling(
      {.mass = {1, 1}, .damping = {0.1, 0.2}, .springs = {{11, 2.7}, {20, 0.66}}, .contact = laws::normal_law(normal)},
      oscillators::contact_of(model), 0.0);
  const auto receptance = sliding_receptance(structure, 0);
  for (const double omega : {0.1, 2.0, 4.5, 30.0}) {
    CAPTURE(omega);
    const Complex s(0, omega);
    Eigen::Matrix2cd D = s * s * structure.M + s * structure.C + structure.K;
    D(0, 1) -= mu * k_n, D(1, 1) += k_n;  // δN = k_n y, friction on the block μ δN along the belt
    const Eigen::Vector2cd expected = D.inverse().col(0);
    const auto answer = receptance.at(s);
    for (const int i : {0, 1})
      CHECK(std::abs(answer.coordinates[std::size_t(i)] - expected[i]) <= answer.errors[std::size_t(i)]);
  }
}

TEST_CASE("contacts that have no friction, or are not there, have no response", "[frf]") {
  auto structure = two_blocks(4);
  CHECK_THROWS_WITH(sliding_receptance(structure, 2), Contains("frf.contact = 3") && Contains("1 … 2"));
  laws::LinearContact normal;
  structure.contacts.push_back(oscillators::frictionless_contact(Eigen::Vector2d(1, 0), laws::normal_law(normal)));
  CHECK_THROWS_WITH(contact_in_sliding(structure, 2), Contains("frf.contact = 3") && Contains("without friction"));
}
