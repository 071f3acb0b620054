/// Surfaces that are not flat: their height over the distance along them, and normal laws of contacts that ride on
/// them.
#pragma once
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "core/signal.hpp"
#include "laws/normal_law.hpp"

namespace rosin::oscillators {

/// Height of a surface above its mean level over the distance x along it: Σ amplitude·cos(2π x/wavelength + phase), m.
struct Profile {
  struct Wave {
    double amplitude, wavelength, phase;  ///< m, m, rad
  };
  std::vector<Wave> waves;

  double height(double x) const;
  double rms() const;  ///< over all distances, where no two wavelengths are the same
  bool is_flat() const;
};

/// A rough track that closes after its length. Its waves are those of whole numbers n in the length, between the
/// longest and the shortest wavelength. They share the mean square as a self-affine profile of Hurst exponent H does,
/// C(k) ~ k^−(1 + 2H) over the wave number k (Persson et al. 2005, J. Phys.: Condens. Matter 17, R1, section 2), and
/// have random phases, the same for the same seed on every machine.
struct RoughTrack {
  double rms = 0, shortest = 0, longest = 0, length = 0;  ///< m
  double hurst = 0.8;
  std::uint64_t seed = 1;
};
/// \throws InputError where no whole number, or more than most_waves, lie between the two wavelengths
Profile profile_of(const RoughTrack&);
inline constexpr int most_waves = 1000;

/// The closed track on which these heights (m) were read at equal spacing (m), once round: their trigonometric
/// interpolation, less their mean. \throws InputError where they are all the same
Profile profile_of(std::span<const double> heights, double spacing);

/// A normal law on a surface that moves by with a constant speed V. At time t the height under a station is that of the
/// profile at the distance V t + ahead; it adds to the approach, and its rate to the approach rate. Asked as a normal
/// law, without a time, it answers as on the mean level.
class OverProfile final : public NormalLaw {
 public:
  /// \param ahead  of each station of the contact, m of the track
  /// \throws InputError for a speed that varies or is 0, and a law that no height changes
  OverProfile(std::shared_ptr<const NormalLaw>, const Profile&, const Signal& speed, std::vector<double> ahead = {0});

  struct Height {
    double level, rate;  ///< m, m/s
  };
  Height under(int station, double t) const;
  int stations() const { return stations_; }
  const Signal& height() const { return height_; }  ///< at the distance V t, m
  bool is_flat() const { return is_flat_; }
  const std::shared_ptr<const NormalLaw>& on_level() const { return law_; }

  const Card& card() const override { return law_->card(); }
  NormalAnswer at(double approach, double rate, double preload) const override {
    return law_->at(approach, rate, preload);
  }
  double approach_under(double preload) const override { return law_->approach_under(preload); }
  double elastic_energy(double approach) const override { return law_->elastic_energy(approach); }
  bool is_smooth_beside_kink() const override { return law_->is_smooth_beside_kink(); }
  double kink(double approach, double rate, double approach_size, double rate_size, double preload) const override {
    return law_->kink(approach, rate, approach_size, rate_size, preload);
  }

 private:
  std::shared_ptr<const NormalLaw> law_;
  Signal height_;
  std::vector<Signal::Harmonic> waves_;
  std::vector<double> cosine_, sine_;  ///< of the phase by which a station is ahead; for each station, of each wave
  int stations_;
  bool is_flat_;
  std::uint64_t number_;  ///< no two have the same
};

/// The profile that a normal law rides on; none: its surface is flat, or it is no law.
const OverProfile* profile_under(const NormalLaw*);

}  // namespace rosin::oscillators
