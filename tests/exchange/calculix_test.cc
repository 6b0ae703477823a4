// CalculiX moves an exported model as Lacuna does. The tests are skipped where ccx is absent.
#include "exchange/calculix.h"

#include <gtest/gtest.h>

#include <fstream>
#include <iostream>
#include <sstream>

#include "exchange/cantilever.h"
#include "exchange/inp_writer.h"
#include "support/interrupted_call.h"
#include "support/temporary_folder.h"

namespace lacuna {
namespace {

CalculixResult Exported(const Cantilever& bar, InpDialect dialect = InpDialect::kCalculix) {
  TemporaryFolder folder;
  const PortableModel model = bar.Describe();
  std::ofstream(folder / "model.inp") << InpText(model, dialect);
  const CalculixResult result =
      RunCalculix(folder / "model.inp", folder / "calculix", model.mesh.NodeCount(), model.frames);
  EXPECT_TRUE(result.IsUsable()) << result.message;
  return result;
}

DisplacementDifference Difference(const Cantilever& bar,
                                  InpDialect dialect = InpDialect::kCalculix) {
  const CalculixResult result = Exported(bar, dialect);
  if (!result.IsUsable()) return {.largest = 1, .rms = 1};
  const DisplacementDifference difference =
      CompareDisplacements(bar.Displacements(), result.displacement);
  std::cout << "largest displacement " << difference.largest_displacement
            << " m, largest difference " << difference.largest << ", rms " << difference.rms
            << "\n";
  return difference;
}

TEST(CompareDisplacements, IsRelativeToTheLargestDisplacement) {
  Eigen::MatrixXd expected = Eigen::MatrixXd::Zero(6, 2), found = expected;
  expected(3, 1) = 4e-3;
  found(3, 1) = 5e-3;
  const DisplacementDifference moved = CompareDisplacements(expected, found);
  EXPECT_TRUE(moved.IsDisplaced(0.1));
  EXPECT_DOUBLE_EQ(moved.largest_displacement, 4e-3);
  EXPECT_NEAR(moved.largest_difference, 1e-3, 1e-15);
  EXPECT_NEAR(moved.largest, 0.25, 1e-12);
  EXPECT_NEAR(moved.rms, 0.125, 1e-12);  // of two nodes at two times, one differs
  // Rounding errors of a body at rest.
  const DisplacementDifference rest = CompareDisplacements(1e-14 * expected, found);
  EXPECT_FALSE(rest.IsDisplaced(0.1));
  EXPECT_NEAR(rest.largest_difference, 5e-3, 1e-15);
}

#define SKIP_WITHOUT_CALCULIX() \
  if (!HasCalculix()) GTEST_SKIP() << "skipped, ccx absent"

// The law is the same in both programs. What remains are the masses: CalculiX spreads the weight
// consistently, Lacuna as lumped masses.
TEST(Calculix, SagsUnderGravityAsLacunaDoes) {
  SKIP_WITHOUT_CALCULIX();
  const Cantilever bar("st_venant_kirchhoff", {8, 2, 2}, 2);
  const DisplacementDifference difference = Difference(bar);
  EXPECT_GT(difference.largest_displacement, 0.005);  // large rotations
  EXPECT_LT(difference.largest, 0.01);
}

// Then nothing differs; ccx prints seven digits.
TEST(Calculix, SagsUnderPointMassesAsLacunaDoes) {
  SKIP_WITHOUT_CALCULIX();
  const Cantilever bar("st_venant_kirchhoff", {8, 2, 2}, 2);
  EXPECT_LT(Difference(bar, InpDialect::kCalculixPointMasses).largest, 1e-5);
}

// For linear elements of the same shape, too: nodes are not mixed up.
TEST(Calculix, SagsWithLinearElements) {
  SKIP_WITHOUT_CALCULIX();
  EXPECT_LT(Difference(Cantilever("st_venant_kirchhoff", {8, 2, 2}, 1)).largest, 0.01);
}

TEST(Calculix, SagsWithConvertedLaws) {
  SKIP_WITHOUT_CALCULIX();
  for (const char* law : {"neo_hookean", "corotational", "linear"})
    EXPECT_LT(Difference(Cantilever(law, {6, 1, 1}, 2)).largest, 0.01) << law;
}

// A displacement that is linear in the position and prescribed on the whole boundary makes all
// interior nodes follow, if each node of an element is where the other program expects it.
TEST(Calculix, PassesThePatchTest) {
  SKIP_WITHOUT_CALCULIX();
  Cantilever bar("linear", {3, 3, 3}, 2);
  bar.mesh = ToQuadratic(Jittered(BoxMesh({0, 0, 0}, {0.06, 0.06, 0.06}, {3, 3, 3}), 0.02, 0.2, 5));
  bar.model.body = std::make_shared<const Body>(MakeBody(bar.mesh, 1000));
  bar.model.effects.pop_back();  // gravity
  const Eigen::VectorXi boundary = bar.model.body->boundary.node;
  const Eigen::Matrix3d gradient{{0.01, 0.002, 0}, {-0.003, 0.02, 0.004}, {0.001, 0, -0.01}};
  const Eigen::Matrix3Xd moved = (Eigen::Matrix3d::Identity() + gradient) * bar.mesh.nodes;
  bar.model.grips = {
      {boundary, [=](double) { return Eigen::Matrix3Xd(moved(Eigen::all, boundary)); }}};
  const CalculixResult result = Exported(bar);
  ASSERT_TRUE(result.IsUsable());
  const Eigen::MatrixXd exact = (moved - bar.mesh.nodes).reshaped();
  // ccx prints seven digits.
  EXPECT_LT(CompareDisplacements(exact, result.displacement.leftCols(1)).largest, 1e-5);
}

// Released from a force at the tip, with both kinds of damping.
TEST(Calculix, RingsDownAsLacunaDoes) {
  SKIP_WITHOUT_CALCULIX();
  Cantilever bar("st_venant_kirchhoff", {6, 1, 1}, 2);
  bar.model.effects.push_back(MakeEffect("mass_damping", {{"alpha", 3}}));
  bar.model.effects.push_back(MakeEffect(
      "stiffness_damping", {{"beta", 0.002}, {"young_modulus", 1e5}, {"poisson_ratio", 0.4}}));
  const Eigen::VectorXd share = BoundaryShares(*bar.model.body, bar.Tip());
  bar.options.held_force = Eigen::VectorXd::Zero(3 * share.size());
  for (Eigen::Index i = 0; i < share.size(); ++i)
    bar.options.held_force[3 * i + 2] = 0.02 * share[i];
  for (int k = 1; k <= 5; ++k) bar.frames.push_back(0.02 * k);
  bar.options.time_step = 2e-3;
  EXPECT_LT(Difference(bar).largest, 0.01);
}

// A grip that shifts and turns, and a force that grows: tables over the time.
TEST(Calculix, FollowsGripsAndLoads) {
  SKIP_WITHOUT_CALCULIX();
  Cantilever bar("st_venant_kirchhoff", {6, 1, 1}, 2);
  const Eigen::Matrix3Xd rest = bar.mesh.nodes(Eigen::all, bar.model.grips[0].nodes);
  bar.model.grips[0].motion = [rest](double time) -> Eigen::Matrix3Xd {
    const Eigen::Matrix3d turn =
        Eigen::AngleAxisd(0.1 * time, Eigen::Vector3d::UnitX()).toRotationMatrix();
    return (turn * rest).colwise() + Eigen::Vector3d(0, 0.002 * time, 0);
  };
  bar.model.effects.push_back(std::make_shared<PrescribedForce>(
      BoundaryShares(*bar.model.body, bar.Tip()),
      [](double time) { return Eigen::Vector3d(0, 0.005 * time, 0.01); }));
  bar.names.loads = {"pull"};
  bar.options.step.scheme = TimeScheme::kQuasiStatic;
  bar.options.time_step = 0.5;
  bar.frames = {1, 2, 3};
  EXPECT_LT(Difference(bar).largest, 0.01);
}

// The forces of the last table "forces (fx,fy,fz) for set … and time …" in a .dat file: 3 × nodes,
// N.
Eigen::Matrix3Xd LastForces(const std::filesystem::path& file, Eigen::Index nodes) {
  std::ifstream stream(file);
  Eigen::Matrix3Xd forces(3, 0);
  std::string line;
  while (std::getline(stream, line)) {
    if (line.find("forces (fx,fy,fz)") == std::string::npos) continue;
    std::getline(stream, line);  // empty
    forces.setZero(3, nodes);
    for (Eigen::Index k = 0; k < nodes && std::getline(stream, line); ++k) {
      std::istringstream fields(line);
      int node = 0;
      double x = 0, y = 0, z = 0;
      fields >> node >> x >> y >> z;
      EXPECT_FALSE(fields.fail()) << line;
      forces.col(node - 1) << x, y, z;
    }
  }
  return forces;
}

// The forces and torques of both ends of a bar that is stretched by 6 %, bent and twisted by 17°.
TEST(Calculix, HasTheReactionsOfLacuna) {
  SKIP_WITHOUT_CALCULIX();
  Cantilever bar("st_venant_kirchhoff", {6, 2, 2}, 2);
  bar.model.effects.pop_back();  // gravity
  const Eigen::VectorXi tip = bar.Tip();
  const Eigen::Matrix3Xd rest = bar.mesh.nodes(Eigen::all, tip);
  bar.model.grips.push_back(
      {tip, [rest](double time) -> Eigen::Matrix3Xd {
         const Eigen::Vector3d centre(0.08, 0.01, 0.01);
         const Eigen::Matrix3d turn =
             Eigen::AngleAxisd(0.3 * time, Eigen::Vector3d::UnitX()).toRotationMatrix();
         return (turn * (rest.colwise() - centre)).colwise() +
                (centre + time * Eigen::Vector3d(0.005, 0, 0.004));
       }});
  bar.names.grips = {"clamp", "jaw"};
  bar.options.step.scheme = TimeScheme::kQuasiStatic;
  bar.options.time_step = 0.25;
  bar.frames = {1};

  const Eigen::Vector3d about(0.02, -0.01, 0.03);
  bar.options.reactions = {{0, {}}, {0, about}, {1, {}}, {1, about}};
  Eigen::VectorXd expected, position;
  ASSERT_TRUE(Predict(bar.model, bar.options, {1}, {}, [&](int, const PredictedState& state) {
                expected = state.reaction;
                position = state.position;
              }).IsUsable());

  TemporaryFolder folder;
  const PortableModel model = bar.Describe();
  std::string text = InpText(model, InpDialect::kCalculix);
  for (size_t at = 0; (at = text.find("*NODE PRINT", at)) != std::string::npos; ++at)
    text.insert(text.find("\nU\n", at) + 2, ", RF");
  std::ofstream(folder / "model.inp") << text;
  const CalculixResult result =
      RunCalculix(folder / "model.inp", folder / "calculix", model.mesh.NodeCount(), model.frames);
  ASSERT_TRUE(result.IsUsable()) << result.message;
  const Eigen::Matrix3Xd forces = LastForces(folder / "calculix/model.dat", model.mesh.NodeCount());
  ASSERT_EQ(forces.cols(), model.mesh.NodeCount());
  const Eigen::VectorXd found =
      SumReactions(bar.model, bar.options.reactions, position, forces.reshaped());
  std::cout << "Lacuna " << expected.transpose() << "\nCalculiX " << found.transpose() << "\n";
  EXPECT_GT(expected.segment<3>(6).norm(), 1);  // N
  for (const int row : {0, 3, 6, 9})
    EXPECT_LT((found - expected).segment<3>(row).norm(), 1e-3 * expected.segment<3>(row).norm())
        << row;
}

// Planes of symmetry, and a plate without friction that compresses the block: supports along some
// axes only. Hooke's law is the same in both programs.
TEST(Calculix, HoldsPartsAlongSomeAxesOnly) {
  SKIP_WITHOUT_CALCULIX();
  Cantilever bar("linear", {4, 2, 2}, 2);
  bar.model.effects.pop_back();  // gravity
  bar.model.grips.clear();
  bar.names.grips.clear();
  for (int axis = 0; axis < 3; ++axis) {
    bar.model.grips.push_back(
        {NodesWhere(bar.mesh, [axis](const Eigen::Vector3d& x) { return x[axis] < 1e-9; }),
         {},
         AxisSet::Of(axis)});
    bar.names.grips.push_back(std::string("plane ") + "xyz"[axis]);
  }
  const Eigen::Matrix3Xd rest = bar.mesh.nodes(Eigen::all, bar.Tip());
  bar.model.grips.push_back({bar.Tip(),
                             [rest](double) -> Eigen::Matrix3Xd {
                               return rest.colwise() + Eigen::Vector3d(-0.001, 0, 0);
                             },
                             AxisSet::Of(0)});
  bar.names.grips.emplace_back("plate");
  bar.options.step.scheme = TimeScheme::kQuasiStatic;
  const DisplacementDifference difference = Difference(bar);
  EXPECT_NEAR(difference.largest_displacement, 0.001, 1e-4);
  EXPECT_LT(difference.largest, 1e-5);  // ccx prints seven digits
}

// In place of ccx, a script that sleeps.
[[noreturn]] void InterruptCalculix(const TemporaryFolder& folder) {
  WriteNumberedScript(folder / "ccx", folder / "number", "exec /bin/sleep 60");
  setenv("PATH", folder.Path().c_str(), 1);
  std::ofstream(folder / "model.inp") << "*NODE\n";
  ExitAfterInterruptedCall(folder / "number",
                           [&] { RunCalculix(folder / "model.inp", folder / "calculix", 1, {}); });
}

TEST(CalculixDeathTest, IsEndedByAnInterrupt) {
  const TemporaryFolder folder;
  EXPECT_EXIT(InterruptCalculix(folder), ::testing::ExitedWithCode(0), "");
}

TEST(Calculix, SaysWhyItStopped) {
  SKIP_WITHOUT_CALCULIX();
  TemporaryFolder folder;
  std::ofstream(folder / "bad.inp") << "*NODE\n1, 0, 0, 0\n*ELEMENT, TYPE=C3D4\n1, 1, 2, 3, 4\n";
  const CalculixResult result = RunCalculix(folder / "bad.inp", folder / "calculix", 1, {});
  EXPECT_EQ(result.status, CalculixResult::Status::kFailed);
  EXPECT_FALSE(result.message.empty());
}

}  // namespace
}  // namespace lacuna
