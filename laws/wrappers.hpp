/// What may surround any law in its contact, by decorating the contact: a law knows nothing of it.
#pragma once
#include <memory>
#include <string>
#include <vector>

#include "laws/law.hpp"

namespace rosin::laws {

/// A contact behind a spring with a damper beside it (ContactSetup::spring): u = v + ė, F = k·e + c·ė, where the law
/// slips at v and e is the deflection, m. Unknowns: those of the law's contact, which must itself be rigid or behind an
/// undamped spring, then
///   e                where it carries friction; v = u − (N·μ − k·e)/c, which needs c > 0;
///   v (m/s) and e    where it does not; 0 = k·e + c·(u − v) − F(v), which needs c + ∂F/∂v > 0.
std::unique_ptr<Contact<double>> behind_spring(std::unique_ptr<Contact<double>> law, const ContactSetup&);
std::unique_ptr<Contact<Lanes>> behind_spring(std::unique_ptr<Contact<Lanes>> law, const ContactSetup&);
/// `slopes`: of the numbers of the spring, in the second direction of towers.
std::unique_ptr<ContactValues<Tower>> behind_spring(std::unique_ptr<ContactValues<Tower>> law, const ContactSetup&,
                                                    const SeriesSpring& slopes);

/// Nothing where the contact of a law goes behind a spring; else the reason why it does not. A set-valued law does if
/// its friction is the same at all slip rates and, without a damper beside the spring, at rest too: else slip begins
/// with a jump.
std::string refusal_of_spring(const FrictionLaw&, bool damped);

/// A contact of dry friction, of the same coefficient at all slip rates, behind a spring (Jenkins 1962): its unknown is
/// the deflection e (m). In stick, where the direction of the input is 0, the spring follows, ė = u and F = k·e + c·u,
/// up to the limit of rest. In slip F = ±μ_d·N; a damped spring relaxes, ė = (F − k·e)/c, and an undamped one has
/// e = F/k, an equation without a rate of its own: 0 = F/k − e.
/// \param law  rigid, without unknowns
std::unique_ptr<Contact<double>> dry_behind_spring(std::unique_ptr<Contact<double>> law, const ContactSetup&);

/// A contact whose states forget a part of their past when the load grows (ContactSetup::load_memory, α): at constant
/// slip rate a change of load changes friction by dμ = −α dN/N, by way of the states, and the rates λ·ψ̇ then bring it
/// back. With μ = … + b·ln θ that is θ̇ = … − (α/b)·θ·Ṅ/N.
/// The states that remember are the logarithmic ones, `remembering` by number; several share the change by their weight
/// in friction (the least change that does). `shape` is a contact of the same law with Unknowns::states and without
/// wrappers. Lanes and towers need no such
/// wrapper: they are asked at constant loads alone.
/// Source: M. F. Linker and J. H. Dieterich, Effects of variable normal stress on rock friction: observations and
/// constitutive equations, J. Geophys. Res. 97, 4923-4940, 1992.
std::unique_ptr<Contact<double>> with_load_memory(std::unique_ptr<Contact<double>> law,
                                                  std::unique_ptr<Contact<double>> shape, std::vector<int> remembering,
                                                  const ContactSetup&);

}  // namespace rosin::laws
