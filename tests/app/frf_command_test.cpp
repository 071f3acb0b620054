/// The verbs frf and fit as a user runs them: the fields that callers rely on, and refusals with their place.
#include <fmt/format.h>

#include <catch2/catch.hpp>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <random>
#include <sstream>

#include "tests/app/command.hpp"

namespace {

namespace fs = std::filesystem;
using Catch::Matchers::Contains;
using nlohmann::json;
using rosin::tests::content;
using rosin::tests::Folder;
using rosin::tests::run_rosin;

const std::string examples = ROSIN_SOURCE_DIR "/examples/";

}  // namespace

TEST_CASE("a response answers in JSON with the fields that callers rely on", "[frf-command]") {
  const Folder folder;
  const auto answer =
      run_rosin(folder, "frf " + examples +
                            "frf-load-family.toml --json --set frf.normal=true --set frf.frequencies=[10,100,1000]");
  INFO(answer.error);
  REQUIRE(answer.status == 0);
  const auto document = json::parse(answer.out);
  CHECK(document["frequency"] == json::array({10.0, 100.0, 1000.0}));
  for (const char* entry : {"tt", "tn", "nt", "nn"}) CHECK(document["matrix"][entry].size() == 3);
  CHECK(document["tangential"] == document["matrix"]["tt"]);
  CHECK(document["tangential"][0].size() == 2);
  CHECK(document["low_frequency_limit"].get<double>() == Approx(16 * (0.010 - 0.012) / 2e-3).epsilon(1e-6));
  CHECK(document["high_frequency_stiffness"].get<double>() == Approx(2e5));
  CHECK(document["family"]["members"].size() == 5);
  CHECK(document["family"]["load_exponent"][2].get<double>() < 0.5);
  for (const char* file : {"frf.csv", "frf.png", "frf.svg", "manifest.json"})
    CHECK(fs::exists(folder.path / "out/frf-load-family" / file));
}

TEST_CASE("a simulated record goes through extraction to the same response, and on into a fit", "[frf-command]") {
  const Folder folder;
  REQUIRE(run_rosin(folder, "frf " + examples + "frf-noise.toml --out noise --quiet").status == 0);
  const auto simulated = json::parse(content(folder.path / "noise/result.json"));
  const auto record = (folder.path / "noise/frf-record.csv").string();
  const auto answer = run_rosin(folder, "frf " + examples + "frf-record.toml --json --set frf.record.file=" + record);
  INFO(answer.error);
  REQUIRE(answer.status == 0);
  const auto extracted = json::parse(answer.out);
  CHECK(extracted["coherence"].size() == extracted["frequency"].size());
  CHECK(extracted["standard_error"].size() == extracted["frequency"].size());
  CHECK(extracted["warnings"].empty());
  CHECK(extracted["tangential"][0][0].get<double>() ==
        Approx(simulated["tangential"][0][0].get<double>()).epsilon(1e-9));
  // A record by itself needs no law.
  std::ofstream(folder.path / "record.toml") << "[frf.record]\nfile = \"noise/frf-record.csv\"\ntime = \"time\"\n"
                                                "slip_rate = \"slip_rate\"\nforce = \"friction_force\"\n"
                                                "resolution = 0.01\n";
  const auto alone = run_rosin(folder, "frf record.toml --json");
  INFO(alone.error);
  REQUIRE(alone.status == 0);
  const auto whole = json::parse(alone.out);
  const auto& bins = whole["frequency"];
  const auto at = std::size_t(std::find(bins.begin(), bins.end(), extracted["frequency"][20]) - bins.begin());
  REQUIRE(at < bins.size());
  CHECK(whole["tangential"][at] == extracted["tangential"][20]);
  CHECK_FALSE(whole.contains("predicted"));

  const auto fitted =
      run_rosin(folder, "fit " + examples + "fit-laws.toml --json --set fit.profiles=false --set fit.starts=1");
  INFO(fitted.error);
  REQUIRE(fitted.status == 0);
  const auto document = json::parse(fitted.out);
  for (const char* path : {"law.mu0", "law.a", "law.b", "law.L"}) {
    const auto& p = document["parameters"][path];
    CHECK(p["interval"][0].get<double>() < p["value"].get<double>());
    CHECK(p["interval"][1].get<double>() > p["value"].get<double>());
    CHECK(p["standard_error"].get<double>() > 0);
  }
  CHECK(document["parameters"]["law.a"]["value"].get<double>() == Approx(0.010).epsilon(1e-3));
  CHECK(document["ranking"][0]["law"] == "ageing");
  CHECK(document["ranking"].size() == 3);
  CHECK(document["ranking"][2]["aic"].get<double>() > document["ranking"][0]["aic"].get<double>());
}

TEST_CASE("a plane slider on a moving surface answers along its slip as the slider of that direction",
          "[frf-command]") {
  const Folder folder;
  const std::string law = "[law]\ntype = 'ageing'\n[frf]\nfrequencies = [0.1, 1, 10]\n";
  std::ofstream(folder.path / "plane.toml")
      << law << "[oscillator]\ntype = 'plane-slider'\nmass = 3\nstiffness = [400, 400]\ndamping = [2, 2]\n"
      << "[drive]\nspeed = [0.06, 0.08]\nnormal_load = 20\n";
  std::ofstream(folder.path / "slider.toml") << law << "[oscillator]\nmass = 3\nstiffness = 400\ndamping = 2\n"
                                             << "[drive]\nspeed = 0.1\nnormal_load = 20\n";
  const auto plane = run_rosin(folder, "frf plane.toml --json --no-pictures"),
             slider = run_rosin(folder, "frf slider.toml --json --no-pictures");
  INFO(plane.error << slider.error);
  REQUIRE(plane.status == 0);
  REQUIRE(slider.status == 0);
  const auto one = json::parse(plane.out), other = json::parse(slider.out);
  for (int k : {0, 1, 2})
    for (int part : {0, 1}) {
      CHECK(one["tangential"][k][part].get<double>() == Approx(other["tangential"][k][part].get<double>()));
      CHECK(one["receptance"]["contact"][k][part].get<double>() ==
            Approx(other["receptance"]["contact"][k][part].get<double>()));
    }
  // What was measured needs no drive, and then the slider does not slide.
  std::ofstream(folder.path / "measured.toml")
      << "[law]\ntype = 'coulomb'\n[oscillator]\ntype = 'plane-slider'\nmass = 3\nstiffness = [400, 400]\n"
      << "damping = [2, 2]\n[frf.record]\nfile = 'none.csv'\nsample_rate = 100\n"
      << "slip_rate = 'v'\nforce = 'F'\nresolution = 1\n";
  const auto measured = run_rosin(folder, "frf measured.toml");
  CHECK(measured.status == 2);
  CHECK_THAT(measured.error, Contains("none.csv"));
}

TEST_CASE("a structure with friction answers by eigenvalues and by Nyquist", "[frf-command]") {
  const Folder folder;
  const auto answer = run_rosin(folder, "frf " + examples + "frf-squeal.toml --json");
  INFO(answer.error);
  REQUIRE(answer.status == 0);
  const auto stability = json::parse(answer.out)["stability"];
  CHECK(stability["unstable_by_eigenvalues"] == stability["unstable_by_nyquist"]);
  CHECK(stability["stable"] == (stability["unstable_by_eigenvalues"] == 0));
  CHECK(stability["critical"].size() >= 1);
  CHECK(stability["uncertainty"]["influence"].size() == 4);
  // The slider of a scene is a structure too: the critical load of the Bristol board.
  const auto slider =
      run_rosin(folder, "frf " + examples +
                            "bristol-board-cycle.toml --json --set frf.frequencies=[0.1] --set "
                            "\"frf.structure.scan={parameter='drive.normal_load', from=1e-5, to=1e-2}\"");
  INFO(slider.error);
  REQUIRE(slider.status == 0);
  CHECK(json::parse(slider.out)["stability"]["critical"][0]["value"].get<double>() ==
        Approx(4.0877514056773e-4).epsilon(1e-9));
}

TEST_CASE("structures are uncertain too, and so are tables with errors", "[frf-command]") {
  const Folder folder;
  const auto squeal = "frf " + examples + "frf-squeal.toml --json --set ";
  const auto modes =
      run_rosin(folder, squeal + "\"frf.structure.uncertain={'structure.modes.1.damping_ratio'=0.3, 'law.b'=0.1}\"");
  INFO(modes.error);
  REQUIRE(modes.status == 0);
  const auto influence = json::parse(modes.out)["stability"]["uncertainty"]["influence"];
  CHECK(influence["structure.modes.1.damping_ratio"].get<double>() < 0);
  CHECK(influence["law.b"].get<double>() > 0.5);
  // A measured response, its errors growing: the margin spreads in proportion.
  double spread[2];
  for (const int k : {0, 1}) {
    std::ofstream file(folder.path / "friction.csv");
    file << "frequency (Hz),real (N s/m),imaginary (N s/m),standard_error (N s/m)\n";
    for (int i = 0; i < 40; ++i) file << 100 + 5 * i << ",-20,3," << (k ? 0.2 : 0.1) << '\n';
    file.close();
    const auto table =
        run_rosin(folder, squeal + "\"frf.structure.friction={file='" + (folder.path / "friction.csv").string() +
                              "', standard_error='standard_error'}\" --set "
                              "\"frf.structure.uncertain={'structure.modes.1.mass'=1e-9}\"");
    INFO(table.error);
    REQUIRE(table.status == 0);
    const auto margin = json::parse(table.out)["stability"]["uncertainty"]["margin"];
    spread[k] = margin[2].get<double>() - margin[0].get<double>();
  }
  CHECK(spread[1] == Approx(2 * spread[0]).epsilon(0.1));
  CHECK(spread[0] > 0);
}

TEST_CASE("what a response or a fit cannot use is refused with its place", "[frf-command]") {
  const Folder folder;
  const auto refused = [&](const std::string& arguments) {
    const auto answer = run_rosin(folder, arguments);
    CHECK(answer.status == 2);
    return answer.error;
  };
  const auto family = "frf " + examples + "frf-load-family.toml --set ";
  CHECK_THAT(refused(family + "frf.frequencies=[]"), Contains("frf.frequencies is empty"));
  CHECK_THAT(refused(family + "frf.frequencies=[2,1]"), Contains("must ascend"));
  CHECK_THAT(refused(family + "frf.frequences=[1]"), Contains("did you mean 'frequencies'"));
  CHECK_THAT(refused(family + "\"frf.sensitivities=['law.c']\""), Contains("unknown parameter"));
  CHECK_THAT(refused(family + "frf.simulate.type=swept-sine"), Contains("frf.family belongs to a prediction"));
  CHECK_THAT(refused(family + "frf.record.file=x.csv"), Contains("needs time (a column) or sample_rate"));
  CHECK_THAT(refused(family + "drive.speed=0"), Contains("drive.speed = 0"));
  CHECK_THAT(refused(family + "frf.structure.M=[[1]]"), Contains("has no 'K'"));
  const auto squeal = "frf " + examples + "frf-squeal.toml --set ";
  CHECK_THAT(refused(squeal + "\"frf.structure.modes=[{damping_ratio=0.1}]\""), Contains("has no 'frequency'"));
  CHECK_THAT(refused(squeal + "\"frf.structure.modes=[{frequency=1, mas=2}]\""), Contains("did you mean 'mass'?"));
  CHECK_THAT(refused(squeal + "\"frf.structure.uncertain={'structure.modes.4.mass'=0.1}\""),
             Contains("did you mean 'structure.modes.1.mass'?"));
  CHECK_THAT(refused("frf " + examples + "frf-record.toml --set frf.record.file=none.csv"), Contains("no such file"));
  CHECK_THAT(refused("fit " + examples + "fit-laws.toml --set \"fit.parameters=['law.q']\""),
             Contains("unknown parameter"));
  CHECK_THAT(refused("fit " + examples + "fit-laws.toml --set fit.data=[]"), Contains("fit.data is empty"));
}

TEST_CASE("a displacement serves where slip rate was not recorded, and lost samples cost their segments",
          "[frf-command]") {
  const Folder folder;
  enum class Gap { none, number, row };
  const auto record = [&](Gap gap) {  // a dashpot of 200 N s/m whose slip rate is straight between samples
    std::ofstream file(folder.path / "x.csv");
    file << "time (s);position (mm);force (N)\n";
    std::mt19937 dice(1);
    double x = 0, before = 0;
    for (int i = 0; i < 4000; ++i) {
      const double v = 0.02 + 1e-3 * (double(dice()) / 4294967296.0 - 0.5);
      if (i > 0) x += 0.5 * (v + before) * 0.005;
      before = v;
      if (gap == Gap::row && i == 1000) continue;
      file << fmt::format("{:.3f};{};{:.9f}\n", i * 0.005,
                          gap == Gap::number && i == 1000 ? std::string("NaN") : fmt::format("{:.9f}", 1e3 * x),
                          3 + 200 * v);
    }
  };
  std::ofstream(folder.path / "x.toml") << "[frf]\nfrequencies = { from = 2, to = 40 }\n[frf.record]\nfile = 'x.csv'\n"
                                           "time = 'time'\ndisplacement = 'position'\nforce = 3\nresolution = 1\n";
  for (const auto gap : {Gap::none, Gap::number, Gap::row}) {
    record(gap);
    const auto ran = run_rosin(folder, "frf x.toml --json");
    INFO(ran.error);
    REQUIRE(ran.status == 0);
    const auto answer = json::parse(ran.out);
    CHECK(answer["frequency"].size() >= 38);
    for (std::size_t k = 0; k < answer["frequency"].size(); ++k) {
      CHECK(answer["tangential"][k][0].get<double>() == Approx(200).epsilon(1e-3));
      CHECK(answer["coherence"][k].get<double>() > 0.999);
    }
    const bool said = answer["warnings"].dump().find("1 of 4000 rows lack a number") != std::string::npos;
    CHECK(said == (gap != Gap::none));
    const bool missing = answer["warnings"].dump().find("stand for 1 that are missing") != std::string::npos;
    CHECK(missing == (gap == Gap::row));
  }
  CHECK_THAT(run_rosin(folder, "frf x.toml --set \"frf.record.slip_rate='position'\"").error,
             Contains("has slip_rate and displacement"));
  std::ofstream(folder.path / "y.toml") << "[frf]\nfrequencies = { from = 2, to = 40 }\n[frf.record]\nfile = 'x.csv'\n"
                                           "time = 'time'\nslip_rate = 'position'\nforce = 3\nresolution = 1\n";
  CHECK_THAT(run_rosin(folder, "frf y.toml").error, Contains("displacement in place of slip_rate"));
}

TEST_CASE("a curve is fitted as a tribometer exported it", "[frf-command]") {
  const Folder folder;
  const auto ran = run_rosin(folder, "fit " + examples + "fit-curve.toml --json --explain");
  INFO(ran.error);
  REQUIRE(ran.status == 0);
  const auto found = json::parse(ran.out)["parameters"];
  CHECK(found["law.mu_s"]["value"].get<double>() == Approx(0.4).epsilon(1e-3));
  CHECK(found["law.mu_d"]["value"].get<double>() == Approx(0.3).epsilon(1e-3));
  CHECK(found["law.v_s"]["value"].get<double>() == Approx(0.02).epsilon(1e-3));
  CHECK(ran.error.find("names in line 4, units in line 5") != std::string::npos);
  CHECK(ran.error.find("1 of 13 rows lack a number") != std::string::npos);
}
