// The .inp file: node order, exact round trips, and what becomes of each part of the model.
#include "exchange/inp_writer.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>

#include "core/error.h"
#include "exchange/cantilever.h"
#include "exchange/described_run.h"
#include "exchange/export_format.h"
#include "exchange/inp_reader.h"
#include "exchange/missing_parts.h"
#include "geometry/shape_functions.h"
#include "support/temporary_folder.h"

namespace lacuna {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

ImportedModel WrittenAndRead(const PortableModel& model, InpDialect dialect) {
  TemporaryFolder folder;
  std::ofstream(folder / "model.inp") << InpText(model, dialect);
  return ReadInp(folder / "model.inp");
}

TEST(InpWriter, IsReadBackWithTheSameBits) {
  for (const int order : {1, 2}) {
    Cantilever bar("st_venant_kirchhoff", {3, 1, 1}, 1);
    TetMesh mesh = Jittered(bar.mesh, 0.02, 0.1, 3);
    // Coordinates that need all digits, and very small ones, which have no exponent in the file.
    mesh.nodes *= 1.0 / 3;
    mesh.nodes(1, 0) = -1.2345678901234567e-18;
    if (order == 2) mesh = ToQuadratic(mesh);
    PortableModel model = bar.Describe();
    model.mesh = mesh;
    for (const InpDialect dialect : {InpDialect::kCalculix, InpDialect::kAbaqus}) {
      const ImportedModel read = WrittenAndRead(model, dialect);
      EXPECT_EQ(read.mesh.nodes, mesh.nodes);
      EXPECT_EQ(read.mesh.tets, mesh.tets);
      ASSERT_EQ(read.node_sets.size(), 2u);
      EXPECT_EQ(read.node_sets[0].name, "ALL_NODES");
      EXPECT_EQ(read.node_sets[1].name, "CLAMP");
      EXPECT_EQ(read.node_sets[1].nodes, model.grips[0].part.nodes);
      ASSERT_EQ(read.materials.size(), 1u);
      EXPECT_EQ(read.materials[0].young_modulus, 1e5);
      EXPECT_EQ(read.materials[0].poisson_ratio, 0.4);
      EXPECT_EQ(read.materials[0].density, 1000);
      EXPECT_THAT(read.notes, IsEmpty());
    }
  }
}

// The manuals of both programs: node 5 lies between 1 and 2, 6 between 2 and 3, 7 between 1 and 3,
// and 8, 9, 10 between 4 and 1, 2, 3.
TEST(InpWriter, PutsTheMidpointsOfEdgesWhereTheManualHasThem) {
  constexpr int kEdges[6][2] = {{0, 1}, {1, 2}, {0, 2}, {0, 3}, {1, 3}, {2, 3}};
  const ImportedModel read =
      WrittenAndRead(Cantilever("linear", {2, 1, 1}, 2).Describe(), InpDialect::kCalculix);
  ASSERT_EQ(read.mesh.Order(), 2);
  for (const auto tet : read.mesh.tets.colwise())
    for (int k = 0; k < 6; ++k) {
      const Eigen::Vector3d middle =
          (read.mesh.nodes.col(tet[kEdges[k][0]]) + read.mesh.nodes.col(tet[kEdges[k][1]])) / 2;
      EXPECT_LT((read.mesh.nodes.col(tet[4 + k]) - middle).norm(), 1e-15);
    }
  EXPECT_NEAR(TetVolumes(read.mesh).sum(), 0.08 * 0.02 * 0.02, 1e-18);
}

TEST(InpWriter, NamesWhatHasNoCounterpart) {
  Cantilever bar("neo_hookean", {2, 1, 1}, 1);
  bar.model.effects.push_back(MakeEffect("mass_damping", {{"alpha", 2}}));
  bar.model.effects.push_back(MakeEffect("pressure", {{"pressure", 100}}));
  bar.model.effects.push_back(
      MakeEffect("viscoelastic_branch",
                 {{"modulus", 3e4}, {"relaxation_time", 0.04}, {"poisson_ratio", 0.4}}));
  EXPECT_THAT(MissingParts(InpCounterparts(bar.Describe(), InpDialect::kCalculix)),
              ElementsAre("pressure", "viscoelastic_branch"));
  EXPECT_THAT(MissingParts(InpCounterparts(bar.Describe(), InpDialect::kAbaqus)),
              ElementsAre("pressure"));
  const std::string text = InpText(bar.Describe(), InpDialect::kCalculix);
  EXPECT_THAT(text, HasSubstr("** pressure: none: "));
  EXPECT_THAT(text, HasSubstr("*DAMPING, ALPHA=2, BETA=0\n"));
}

TEST(InpWriter, RefusesDampingThatIsNotProportionalToTheStiffness) {
  Cantilever bar("corotational", {2, 1, 1}, 1);
  bar.model.effects.push_back(MakeEffect(
      "stiffness_damping", {{"beta", 0.01}, {"young_modulus", 2e5}, {"poisson_ratio", 0.4}}));
  EXPECT_THAT(MissingParts(InpCounterparts(bar.Describe(), InpDialect::kCalculix)), IsEmpty());
  // β E_damping/E = 0.01 · 2
  EXPECT_THAT(InpText(bar.Describe(), InpDialect::kCalculix),
              HasSubstr("*DAMPING, ALPHA=0, BETA=0.02\n"));
  bar.model.effects.back() = MakeEffect(
      "stiffness_damping", {{"beta", 0.01}, {"young_modulus", 2e5}, {"poisson_ratio", 0.3}});
  EXPECT_THAT(MissingParts(InpCounterparts(bar.Describe(), InpDialect::kCalculix)),
              ElementsAre("stiffness_damping"));
  EXPECT_THAT(InpText(bar.Describe(), InpDialect::kCalculix), Not(HasSubstr("*DAMPING, ALPHA")));
}

// Lacuna's quasi-static steps have velocities, those of the other programs have none.
TEST(InpWriter, HasNoDampingInAQuasiStaticMotion) {
  Cantilever bar("corotational", {2, 1, 1}, 1);
  bar.model.effects.push_back(MakeEffect("mass_damping", {{"alpha", 2}}));
  bar.model.effects.push_back(MakeEffect(
      "stiffness_damping", {{"beta", 0.01}, {"young_modulus", 2e5}, {"poisson_ratio", 0.4}}));
  bar.frames = {0.1};
  bar.options.step.scheme = TimeScheme::kQuasiStatic;
  for (const InpDialect dialect :
       {InpDialect::kCalculix, InpDialect::kCalculixPointMasses, InpDialect::kAbaqus}) {
    EXPECT_THAT(MissingParts(InpCounterparts(bar.Describe(), dialect)),
                ElementsAre("mass_damping", "stiffness_damping"));
    EXPECT_THAT(InpText(bar.Describe(), dialect), Not(HasSubstr("*DAMPING, ALPHA=")));
  }
}

// The interval of a fit is not that of the value with the elements and steps of the fit.
TEST(InpWriter, NamesTheValueThatAnIntervalBelongsTo) {
  PortableModel model = Cantilever("linear", {2, 1, 1}, 1).Describe();
  model.parameters = {{"young_modulus", "Pa", {29000}, true, 40000, 142000}};
  EXPECT_THAT(InpText(model, InpDialect::kCalculix),
              AllOf(HasSubstr("young_modulus = 29000 Pa (fitted; 95 % interval 40000 to 142000)\n"),
                    Not(HasSubstr("at_limit"))));
  model.parameters[0].at_limit = 75000;
  EXPECT_THAT(InpText(model, InpDialect::kCalculix),
              AllOf(HasSubstr("young_modulus = 29000 Pa (fitted; at_limit 75000, 95 % interval "
                              "40000 to 142000)\n"),
                    HasSubstr("infinitely fine")));
}

// By hand, E = 1e5, ν = 0.4: μ = 35714.2857…, K = 166666.6…, hence C10 = 17857.1428…, D1 = 1.2e-5.
// A branch of a third of E and the same ν takes g = k = (1/3)/(1 + 1/3) = 1/4.
TEST(InpWriter, ConvertsTheNeoHookeanLawAndABranch) {
  Cantilever bar("neo_hookean", {2, 1, 1}, 1);
  bar.model.effects.push_back(
      MakeEffect("viscoelastic_branch",
                 {{"modulus", 1e5 / 3}, {"relaxation_time", 0.04}, {"poisson_ratio", 0.4}}));
  EXPECT_THAT(InpText(bar.Describe(), InpDialect::kCalculix),
              HasSubstr("*HYPERELASTIC, NEO HOOKE\n17857.14285714, 1.2e-05\n"));
  EXPECT_THAT(InpText(bar.Describe(), InpDialect::kAbaqus),
              HasSubstr("*HYPERELASTIC, NEO HOOKE, MODULI=LONG TERM\n17857.14285714, 1.2e-05\n"
                        "*VISCOELASTIC, TIME=PRONY\n0.25, 0.25, 0.04\n"));
}

// The weight of a node is a constant force, or a part of its amplitude where measured forces act.
TEST(InpWriter, WritesPointMassesWithTheirWeights) {
  const PortableModel model = LoadedCantilever("linear", 1).Describe();
  const std::string text = InpText(model, InpDialect::kCalculixPointMasses);
  EXPECT_THAT(text, Not(HasSubstr("GRAV")));
  EXPECT_THAT(text, HasSubstr("*DENSITY\n1e-06\n"));
  EXPECT_THAT(text,
              HasSubstr(fmt::format("*ELEMENT, TYPE=MASS, ELSET=MASS_1\n{}, 1\n*MASS, "
                                    "ELSET=MASS_1\n{}\n",
                                    model.mesh.TetCount() + 1, InpNumber(model.node_mass[0]))));
  const auto weight = [&](int node) { return InpNumber(-9.81 * model.node_mass[node]); };
  const int free = 0, loaded = model.loads[0].part.nodes.front();
  const size_t motion = text.find("** The motion");
  ASSERT_NE(motion, std::string::npos);
  EXPECT_THAT(text.substr(motion), HasSubstr(fmt::format("\n{}, 3, {}\n", free + 1, weight(free))));
  EXPECT_THAT(text.substr(motion),
              HasSubstr(fmt::format("*CLOAD, AMPLITUDE=F_NODE_{0}_Z\n{0}, 3, 1\n", loaded + 1)));
  EXPECT_THAT(InpText(model, InpDialect::kCalculix), Not(HasSubstr("TYPE=MASS")));
}

// The weights of linear elements are the same, lumped or consistent.
TEST(InpWriter, SaysWhereGravityAndDensityAreConverted) {
  const auto kind = [](const PortableModel& model, InpDialect dialect, const std::string& part) {
    for (const Counterpart& one : InpCounterparts(model, dialect))
      if (one.part == part) return one.kind;
    return Counterpart::Kind::kNone;
  };
  PortableModel linear = Cantilever("linear", {2, 1, 1}, 1).Describe();
  const PortableModel quadratic = Cantilever("linear", {2, 1, 1}, 2).Describe();
  for (const InpDialect dialect : {InpDialect::kCalculix, InpDialect::kAbaqus}) {
    EXPECT_EQ(kind(linear, dialect, "gravity"), Counterpart::Kind::kExact);
    EXPECT_EQ(kind(quadratic, dialect, "gravity"), Counterpart::Kind::kConverted);
  }
  const InpDialect lumped = InpDialect::kCalculixPointMasses;
  EXPECT_EQ(kind(quadratic, lumped, "gravity"), Counterpart::Kind::kExact);
  linear.frames = {0.1};
  EXPECT_EQ(kind(linear, lumped, "density"), Counterpart::Kind::kNone);  // a part of the inertia
  linear.is_static = true;
  EXPECT_EQ(kind(linear, lumped, "density"), Counterpart::Kind::kConverted);
  EXPECT_EQ(kind(linear, InpDialect::kCalculix, "density"), Counterpart::Kind::kNone);
}

// Without a frame the file ends with the equilibrium, so that its comment names no *DYNAMIC either.
TEST(InpWriter, SaysNothingOfInertiaWithoutAMotion) {
  Cantilever bar("linear", {2, 1, 1}, 1);
  for (const InpDialect dialect : {InpDialect::kCalculix, InpDialect::kCalculixPointMasses}) {
    bar.frames = {0.1};
    EXPECT_THAT(InpText(bar.Describe(), dialect), HasSubstr("** inertia: converted: "));
    bar.frames.clear();
    EXPECT_THAT(InpText(bar.Describe(), dialect), Not(HasSubstr("*DYNAMIC")));
  }
}

TEST(FramesUntil, KeepsFramesOnTheModelsClockAndRefusesToLoseTheWholeMotion) {
  const std::vector<double> times = {0, 1, 2, 3};  // recorded half a second late
  EXPECT_THAT(FramesUntil(2, times, 0.5, 1), ElementsAre(-0.5, 0.5, 1.5));
  EXPECT_THAT(FramesUntil(INFINITY, times, 0.5, 1), ElementsAre(-0.5, 0.5, 1.5, 2.5));
  for (const double until : {-1.0, 1.9})
    EXPECT_THAT([&] { FramesUntil(until, times, 0.5, 1); },
                testing::ThrowsMessage<InputError>(
                    HasSubstr("leaves nothing of the motion, whose first frame is at 2 s")));
  // A recording of the equilibrium alone has no motion to lose.
  EXPECT_THAT(FramesUntil(INFINITY, {1}, 0, 1), ElementsAre(1));
  EXPECT_THAT(FramesUntil(0, {1}, 0, 1), IsEmpty());
}

TEST(InpWriter, MakesNamesOfSetsThatAreValidAndUnique) {
  EXPECT_THAT(InpSetNames({{"clamp", {}}, {"Clamp", {}}, {"52 g", {}}, {"", {}}, {"body", {}}}),
              ElementsAre("CLAMP", "CLAMP_2", "N_52_G", "N_", "BODY_2"));
}

// A name from a recording stays within its comment.
TEST(InpWriter, WritesNoLineOfTheRecordingsOwn) {
  PortableModel model = Cantilever("linear", {2, 1, 1}, 1).Describe();
  model.run = model.regions[0].name = "x\n*NODE";
  EXPECT_THAT(InpText(model, InpDialect::kCalculix), HasSubstr("** \"x *NODE\" in the recording"));
  EXPECT_EQ(WrittenAndRead(model, InpDialect::kCalculix).mesh.nodes, model.mesh.nodes);
}

TEST(InpWriter, WritesNumbersThatBothProgramsRead) {
  for (const double value : {-1.2345678901234567e-100, 1.0 / 3, -2e300, 0.0})
    EXPECT_LE(InpNumber(value).size(), 20u) << value;
}

TEST(ExportFormats, AreFoundByName) {
  EXPECT_EQ(FindExportFormat("inp").program, "CalculiX");
  EXPECT_THROW(FindExportFormat("imp"), InputError);
}

// A plane of symmetry, and a plate that moves along z only.
TEST(InpWriter, HoldsPartsAlongTheirAxesOnly) {
  Cantilever bar("st_venant_kirchhoff", {2, 1, 1}, 1);
  bar.model.grips[0].axes = AxisSet::Of(1) | AxisSet::Of(2);
  const Eigen::Matrix3Xd rest = bar.mesh.nodes(Eigen::all, bar.Tip());
  bar.model.grips.push_back(
      {bar.Tip(),
       [rest](double) -> Eigen::Matrix3Xd { return rest.colwise() + Eigen::Vector3d(1, 1, 0.001); },
       AxisSet::Of(2)});
  bar.names.grips.emplace_back("plate");
  const std::string text = InpText(bar.Describe(), InpDialect::kCalculix);
  EXPECT_THAT(text, HasSubstr("*BOUNDARY\nCLAMP, 2, 2\nCLAMP, 3, 3\n"));
  EXPECT_THAT(text, HasSubstr("*BOUNDARY, AMPLITUDE=U_PLATE_Z\nPLATE, 3, 3, 1.\n"));
  EXPECT_THAT(text, Not(HasSubstr("U_PLATE_X")));
}

}  // namespace
}  // namespace lacuna
