// From an .inp file to an experiment that can be fitted.
#include "exchange/imported_experiment.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "core/error.h"
#include "exchange/cantilever.h"
#include "exchange/inp_writer.h"
#include "geometry/mesh_io.h"
#include "prediction/predicted_body.h"
#include "prediction/prediction_study_reader.h"
#include "support/temporary_folder.h"

namespace lacuna {
namespace {

using testing::HasSubstr;

ImportedModel Imported(const TemporaryFolder& folder, int order) {
  std::ofstream(folder / "bar.inp") << InpText(
      Cantilever("st_venant_kirchhoff", {2, 1, 1}, order).Describe(), InpDialect::kCalculix);
  return ReadInp(folder / "bar.inp");
}

std::string Replaced(std::string text, const std::string& old, const std::string& with) {
  EXPECT_THAT(text, HasSubstr(old));
  return text.replace(text.find(old), old.size(), with);
}

TEST(ImportedExperiment, CanBeReadOnceItIsCompleted) {
  for (const int order : {1, 2}) {
    TemporaryFolder folder;
    const ImportedModel model = InSiUnits(Imported(folder, order), InpUnits::kMetre);
    WriteImportedExperiment(model, "bar", folder / "bar.inp", folder / "study");
    EXPECT_EQ(ReadTetMesh(folder / "study/bar.msh").mesh.nodes, model.mesh.nodes);
    // What a user does: write the measurements, and use a node set.
    std::ofstream(folder / "study/markers.csv") << "t,tip_x,tip_y,tip_z\n0,0.08,0,0\n0.01,0.08,0,"
                                                   "0\n0.02,0.08,0,-0.001\n0.03,0.08,0,-0.002\n";
    const std::filesystem::path recording = folder / "study/recording.yaml";
    const std::string used = Replaced(Replaced(FileContent(recording), "# fixed:\n", "fixed:\n"),
                                      "#   - {name: CLAMP", "   - {name: CLAMP");
    std::ofstream(recording) << used;
    const PredictionStudy study = ReadPredictionStudy(Config::Load(folder / "study/bar.yaml"));
    EXPECT_EQ(study.density, 1000);
    EXPECT_EQ(study.effects.front()->Parameters(), Eigen::Vector2d(1e5, 0.4));
    const TetMesh body = MakeReferenceBody(study).mesh;
    EXPECT_EQ(body.nodes, model.mesh.nodes);
    EXPECT_EQ(body.tets, model.mesh.tets);
    const Region& clamp = study.recordings[0].recording.object.fixed.at(0).region;
    EXPECT_EQ(SelectNodes(clamp, body), model.node_sets[1].nodes);
  }
}

TEST(ImportedExperiment, ConvertsMillimetres) {
  ImportedModel model;
  model.mesh = BoxMesh({0, 0, 0}, {80, 20, 20}, {1, 1, 1});
  model.materials = {{"GEL", 0.1, 0.45, 1.07e-9}};
  const ImportedModel si = InSiUnits(model, InpUnits::kMillimetre);
  EXPECT_NEAR(si.mesh.nodes.maxCoeff(), 0.08, 1e-15);
  EXPECT_NEAR(*si.materials[0].young_modulus, 1e5, 1e-9);
  EXPECT_NEAR(*si.materials[0].density, 1070, 1e-9);
  EXPECT_EQ(si.materials[0].poisson_ratio, 0.45);
}

ImportedModel ABox() {
  ImportedModel model;
  model.mesh = BoxMesh({0, 0, 0}, {0.08, 0.02, 0.02}, {1, 1, 1});
  return model;
}

// The experiment "recording" would be the file that describes the recording; a name that begins
// with a dot is refused when the experiment is read.
TEST(ImportedExperiment, RefusesNamesThatAnExperimentCannotHave) {
  TemporaryFolder folder;
  for (const char* name : {"recording", ".bar", "a\\b", "a\nb"}) {
    EXPECT_THAT(
        [&] {
          WriteImportedExperiment(ABox(), name, std::string(name) + ".inp", folder / "study");
        },
        testing::ThrowsMessage<InputError>(HasSubstr("the experiment is named after the file")))
        << name;
    EXPECT_FALSE(std::filesystem::exists(folder / "study")) << name;
  }
}

// The names that InpText takes for itself are free here.
TEST(ImportedExperiment, KeepsTheNamesOfSetsWhereItCan) {
  TemporaryFolder folder;
  ImportedModel model = ABox();
  model.node_sets = {{"BODY", {0}}, {"ALL_NODES", {1}}, {"52 G", {2}}};
  const std::vector<std::string> written =
      WriteImportedExperiment(model, "box", "box.inp", folder / "study");
  EXPECT_THAT(written,
              testing::IsSupersetOf({"nodes_BODY.txt", "nodes_ALL_NODES.txt", "nodes_N_52_G.txt"}));
  const std::string recording = FileContent(folder / "study/recording.yaml");
  EXPECT_THAT(recording, HasSubstr("#   - {name: BODY, nodes_file: nodes_BODY.txt}\n"));
  EXPECT_THAT(recording, HasSubstr("nodes_file: nodes_N_52_G.txt}   # 52 G in the file\n"));
}

// A line break in a comment would end it.
TEST(ImportedExperiment, WritesNoLineOfTheFilesOwn) {
  TemporaryFolder folder;
  ImportedModel model = ABox();
  model.materials = {{"GEL", 1e5, 0.45, 1000.0}, {"b\nmesh: {}", {}, {}, {}}};
  model.not_read = {"line 3: *A\rdensity: 1 kg/m^3"};
  WriteImportedExperiment(model, "box", "box.in\rname: x\np", folder / "study");
  for (const char* file : {"recording.yaml", "box.yaml"}) {
    const std::string text = FileContent(folder / "study" / file);
    EXPECT_THAT(text, HasSubstr("# Made from box.in name: x p. "));
    EXPECT_THAT(text, testing::Not(HasSubstr("\r")));
    EXPECT_NO_THROW(Config::Parse(text, file).Text("name"));
  }
  EXPECT_THAT(FileContent(folder / "study/box.yaml"),
              HasSubstr("# The file has another material, b mesh: {}, which is not used\n"));
}

TEST(ImportedExperiment, SaysWhichOfSeveralMaterialsItTakes) {
  TemporaryFolder folder;
  ImportedModel model = ABox();
  const auto material = [&](const char* name) {
    WriteImportedExperiment(model, name, "box.inp", folder / name);
    const std::string text = FileContent(folder / name / (std::string(name) + ".yaml"));
    const size_t begin = text.find("material:");
    return text.substr(begin, text.find('\n', begin) - begin);
  };
  model.materials = {{"GEL", 1e5, 0.45, 1000.0}};
  EXPECT_EQ(MaterialOfBody(model), &model.materials[0]);
  EXPECT_THAT(material("one"), testing::Not(HasSubstr("TO DO")));
  model.materials.insert(model.materials.begin(), {"FOAM", {}, {}, 50.0});
  model.materials.push_back({"STEEL", 2e11, 0.3, 7800.0});
  EXPECT_EQ(MaterialOfBody(model), &model.materials[1]);
  EXPECT_THAT(material("three"),
              HasSubstr("young_modulus: 100000 Pa, poisson_ratio: 0.45}   # TO DO: the file has 3 "
                        "materials; that of GEL is taken for the whole body"));
  // The sections of the file decide before the order of the materials.
  model.materials.back().element_count = 2;
  EXPECT_EQ(MaterialOfBody(model), &model.materials[2]);
  EXPECT_THAT(material("part"), HasSubstr("# TO DO: 2 of 6 elements have STEEL, which is taken"));
  model.materials.back().element_count = 6;
  EXPECT_THAT(material("whole"), testing::Not(HasSubstr("TO DO")));
  model.materials = {{"GEL", 1e5, 0.45, 1000.0, true}};
  EXPECT_THAT(material("instantaneous"), HasSubstr("# TO DO: the modulus of the shortest times"));
}

TEST(ImportedExperiment, OverwritesNothingAndSaysWhatIsUnknown) {
  TemporaryFolder folder;
  ImportedModel model = ABox();
  model.not_read = {"line 3: *BOUNDARY"};
  WriteImportedExperiment(model, "a: b", "a.inp", folder / "study");
  const std::string experiment = FileContent(folder / "study/a: b.yaml");
  EXPECT_THAT(experiment, HasSubstr("TO DO: not in the file"));
  EXPECT_THAT(experiment, HasSubstr("#   line 3: *BOUNDARY"));
  EXPECT_THROW(WriteImportedExperiment(model, "a: b", "a.inp", folder / "study"), InputError);
}

}  // namespace
}  // namespace lacuna
