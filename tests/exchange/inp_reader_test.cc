// Input files of other programs, sound and hostile ones.
#include "exchange/inp_reader.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "core/error.h"
#include "exchange/cantilever.h"
#include "exchange/inp_writer.h"
#include "support/temporary_folder.h"

namespace lacuna {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

ImportedModel Read(const std::string& text) {
  TemporaryFolder folder;
  std::ofstream(folder / "model.inp", std::ios::binary) << text;
  return ReadInp(folder / "model.inp");
}

std::string ErrorOf(const std::string& text) {
  try {
    Read(text);
  } catch (const InputError& problem) {
    return problem.what();
  }
  return "no error";
}

constexpr const char* kTet = R"(*Heading
 a comment of the user, *with stars
** comment
*NODE, nset=All
 10, 0., 0., 0.
 20, 1.D0, 0., 0.
 30, 0., +1e0, 0.
 40, 0., 0., 1.
*Element, type=c3d4, elset=soft
7, 10, 20, 30,
 40
*Nset, nset=foot, generate
10, 30, 10
*NSET, NSET=Both
foot, 40
*ELSET, ELSET=E2
7
*Material, name=Gel
*Density
1e-9,
*Elastic
 0.1, 0.45
*Boundary
foot, 1, 3
*Step, nlgeom
*Static
*End Step
)";

TEST(InpReader, ReadsWhatOtherProgramsWrite) {
  const ImportedModel model = Read(kTet);
  EXPECT_EQ(model.mesh.NodeCount(), 4);
  EXPECT_EQ(model.mesh.nodes.col(2), Eigen::Vector3d(0, 1, 0));
  EXPECT_EQ(model.mesh.tets.col(0), Eigen::Vector4i(0, 1, 2, 3));
  ASSERT_EQ(model.node_sets.size(), 3u);
  EXPECT_EQ(model.node_sets[1].name, "FOOT");
  EXPECT_THAT(model.node_sets[1].nodes, ElementsAre(0, 1, 2));
  EXPECT_THAT(model.node_sets[2].nodes, ElementsAre(0, 1, 2, 3));
  ASSERT_EQ(model.element_sets.size(), 2u);
  EXPECT_THAT(model.element_sets[1].nodes, ElementsAre(0));
  ASSERT_EQ(model.materials.size(), 1u);
  EXPECT_EQ(model.materials[0].name, "GEL");
  EXPECT_EQ(model.materials[0].young_modulus, 0.1);
  EXPECT_EQ(model.materials[0].density, 1e-9);
  EXPECT_THAT(model.not_read, ElementsAre("line 23: *Boundary", "line 25: *Step, nlgeom",
                                          "line 26: *Static", "line 27: *End Step"));
}

std::string Replaced(std::string text, const std::string& old, const std::string& with) {
  text.replace(text.find(old), old.size(), with);
  return text;
}

TEST(InpReader, RefusesWhatItCannotTrustWithTheLine) {
  const std::string tet = kTet;
  EXPECT_THAT(ErrorOf(Replaced(tet, "1.D0", "nan")), HasSubstr("model.inp:6: got \"nan\""));
  EXPECT_THAT(ErrorOf(Replaced(tet, "1.D0", "1e999")), HasSubstr(":6:"));
  EXPECT_THAT(ErrorOf(Replaced(tet, "1.D0, 0., 0.", "1, 0")), HasSubstr(":6: the line ends"));
  EXPECT_THAT(ErrorOf(Replaced(tet, " 20, 1.D0", " 10, 1.")), HasSubstr(":6: node 10 appears"));
  EXPECT_THAT(ErrorOf(Replaced(tet, " 40\n*Nset", " 41\n*Nset")),
              HasSubstr(":11: there is no node"));
  EXPECT_THAT(ErrorOf(Replaced(tet, " 40\n*Nset", " 40, 10\n*Nset")),
              HasSubstr("more than 4 nodes"));
  EXPECT_THAT(ErrorOf(Replaced(tet, "10, 30, 10", "1, 2147483647, 1")),
              HasSubstr(":13: 2147483643 of the 2147483647 numbers do not exist"));
  EXPECT_THAT(ErrorOf(Replaced(tet, "10, 30, 10", "10, 99999999999999999999")), HasSubstr(":13:"));
  EXPECT_THAT(ErrorOf(Replaced(tet, "10, 30, 10", "30, 10")), HasSubstr(":13: the last number"));
  EXPECT_THAT(ErrorOf(Replaced(tet, "foot, 40", "feet, 40")), HasSubstr(":15: got \"feet\""));
  EXPECT_THAT(ErrorOf(Replaced(tet, "0.1, 0.45", "0.1, 0.45\n0.2, 0.45, 20.")),
              HasSubstr(":23: a second line of *ELASTIC"));
  EXPECT_THAT(ErrorOf(Replaced(tet, "0.1, 0.45", "0.1, 0.5")), HasSubstr("Poisson's ratio"));
  EXPECT_THAT(ErrorOf(Replaced(tet, "*Elastic", "*Elastic, type=ortho")), HasSubstr("isotropic"));
  EXPECT_THAT(ErrorOf(Replaced(tet, "type=c3d4", "type=s3")), HasSubstr("no tetrahedra"));
  EXPECT_THAT(ErrorOf(Replaced(tet, "type=c3d4, ", "")), HasSubstr("needs TYPE"));
  EXPECT_THAT(ErrorOf("*INCLUDE, INPUT=mesh.inp\n"), HasSubstr("*INCLUDE"));
  EXPECT_THAT(ErrorOf(Replaced(tet, "*NODE", "*System\n1., 0., 0.\n*NODE")),
              HasSubstr(":4: *SYSTEM is not read: give the coordinates of all nodes"));
  EXPECT_THAT(
      ErrorOf(Replaced(tet, "*Boundary", "*Instance, name=I, part=P\n0., 0., 5.\n*Boundary")),
      HasSubstr(":24: *INSTANCE with a translation or a rotation is not read"));
  EXPECT_THAT(ErrorOf("1, 2, 3\n"), HasSubstr(":1: expected a keyword"));
  EXPECT_THAT(ErrorOf(""), HasSubstr("no tetrahedra"));
}

// The types that are usual for rubber.
TEST(InpReader, ReadsVariantsOfTetrahedraWithANote) {
  const ImportedModel model = Read(Replaced(kTet, "type=c3d4", "type=C3D4H"));
  EXPECT_EQ(model.mesh.TetCount(), 1);
  EXPECT_THAT(model.notes, ElementsAre(HasSubstr("type C3D4H are read as C3D4")));
}

TEST(InpReader, RefusesOtherVolumeElementsAndNamesTheTypesOfTheFile) {
  const std::string wedges =
      "*Element, type=C3D6R\n8, 10, 20, 30, 40, 10,\n20\n"
      "9, 10, 20, 30, 40, 10,\n20\n*Nset, nset=foot";
  EXPECT_THAT(ErrorOf(Replaced(kTet, "*Nset, nset=foot", wedges)),
              HasSubstr(":12: has 2 volume elements that are not read, the first of them of type "
                        "C3D6R"));
  EXPECT_THAT(ErrorOf(Replaced(kTet, "type=c3d4", "type=s3")),
              HasSubstr("no tetrahedra (C3D4, C3D10 and their variants); its elements are of type "
                        "S3"));
}

TEST(InpReader, CountsTheElementsOfEachMaterial) {
  const std::string section = "*Solid Section, elset=Soft, material=gel\n1.,\n*Boundary";
  const ImportedModel model = Read(Replaced(kTet, "*Boundary", section));
  EXPECT_EQ(model.materials[0].element_count, 1u);
  EXPECT_EQ(model.not_read.size(), 4u);
  const ImportedModel without = Read(Replaced(kTet, "*Boundary", Replaced(section, "gel", "foam")));
  EXPECT_EQ(without.materials[0].element_count, 0u);
  EXPECT_THAT(without.not_read, testing::Contains(HasSubstr(": *Solid Section, elset=Soft")));
}

TEST(InpReader, OpensNoOtherFile) {
  TemporaryFolder folder;
  std::ofstream(folder / "nodes.inp") << " 10, 0., 0., 0.\n";
  const auto error = [&](const std::string& old, const std::string& with) {
    std::ofstream(folder / "model.inp") << Replaced(kTet, old, with);
    try {
      ReadInp(folder / "model.inp");
    } catch (const InputError& problem) {
      return std::string(problem.what());
    }
    return std::string("no error");
  };
  EXPECT_THAT(error("** comment", "*INCLUDE, INPUT=nodes.inp"),
              HasSubstr("model.inp:3: *INCLUDE is not read"));
  EXPECT_THAT(error("*NODE, nset=All", "*NODE, input=nodes.inp"),
              HasSubstr("model.inp:4: *NODE with INPUT is not read"));
  EXPECT_THAT(error("elset=soft", "input=nodes.inp"), HasSubstr(":9: *ELEMENT with INPUT"));
  EXPECT_THAT(error("*Elastic", "*Elastic, input=nodes.inp"), HasSubstr("*ELASTIC with INPUT"));
}

TEST(InpReader, RefusesCylindricalCoordinates) {
  EXPECT_THAT(ErrorOf(Replaced(kTet, "nset=All", "system=C")),
              HasSubstr(":4: only Cartesian coordinates are read, not SYSTEM=C"));
  EXPECT_EQ(Read(Replaced(kTet, "nset=All", "system=R")).mesh.NodeCount(), 4);
}

TEST(InpReader, NamesTheFirstLineOfWhatContinues) {
  EXPECT_THAT(Read(Replaced(kTet, "*Step, nlgeom", "*Step,\n**\n nlgeom")).not_read[1],
              "line 25: *Step,");
  // The third corner moves into the plane of the others.
  EXPECT_THAT(ErrorOf(Replaced(kTet, "40, 0., 0., 1.", "40, 1., 1., 0.")),
              HasSubstr(":10: tetrahedron 1 has no volume"));
}

// What follows would be taken for parameters, so that a node or a keyword would be lost in silence.
TEST(InpReader, RefusesAKeywordLineThatEndsWithACommaBeforeDataOrAKeyword) {
  EXPECT_THAT(ErrorOf(Replaced(kTet, "nset=All", "nset=All,")),
              HasSubstr(":5: the keyword line above ends with a comma; got \"10, 0., 0., 0.\""));
  EXPECT_THAT(ErrorOf(Replaced(kTet, "*Static", "*Static,")), HasSubstr(":27: the keyword line"));
}

// A carriage return ends a line of YAML, in which the name stands as a comment.
TEST(InpReader, RefusesControlCharactersInNames) {
  EXPECT_THAT(ErrorOf(Replaced(kTet, "name=Gel", "name=Gel\routput: /")),
              HasSubstr(":18: a keyword line holds a control character"));
  EXPECT_THAT(ErrorOf(Replaced(kTet, "*Boundary", "*Bound\rary")), HasSubstr("control character"));
  EXPECT_EQ(Read(Replaced(kTet, "name=Gel", "\tname=Gel\r")).materials[0].name, "GEL");
}

// The form of Abaqus for the nodes of an element set, which has no data lines.
TEST(InpReader, ReadsTheNodesOfAnElementSet) {
  const auto with = [](const std::string& lines) {
    return Replaced(kTet, "*Material", lines + "\n*Material");
  };
  const ImportedModel model = Read(with("*Nset, nset=whole, elset=soft, internal"));
  ASSERT_EQ(model.node_sets.size(), 4u);
  EXPECT_EQ(model.node_sets[3].name, "WHOLE");
  EXPECT_THAT(model.node_sets[3].nodes, ElementsAre(0, 1, 2, 3));
  EXPECT_THAT(ErrorOf(with("*Nset, nset=whole, elset=hard")),
              HasSubstr(":18: there is no element set HARD above"));
  EXPECT_THAT(ErrorOf(with("*Nset, nset=whole, elset=soft\n10")),
              HasSubstr(":19: expected a keyword line"));
  EXPECT_THAT(ErrorOf(with("*Nset, nset=whole, elset")), HasSubstr(":18: *NSET needs ELSET"));
}

TEST(InpReader, ListsAnInstanceThatIsNotMovedAsNotRead) {
  EXPECT_EQ(Read(Replaced(kTet, "*Boundary", "*Instance, name=I, part=P\n*Boundary")).not_read[0],
            "line 23: *Instance, name=I, part=P");
}

TEST(InpReader, FindsASetWhoseNameStandsInQuotes) {
  const ImportedModel model = Read(
      Replaced(Replaced(kTet, "nset=foot, ", "nset=\"my foot\", "), "foot, 40", "\"My Foot\", 40"));
  EXPECT_EQ(model.node_sets[1].name, "MY FOOT");
  EXPECT_THAT(model.node_sets[2].nodes, ElementsAre(0, 1, 2, 3));
}

TEST(InpReader, NotesTheModulusOfTheShortestTimes) {
  EXPECT_FALSE(
      Read(Replaced(kTet, "*Elastic", "*Elastic, moduli=long term")).materials[0].is_instantaneous);
  EXPECT_TRUE(Read(Replaced(kTet, "*Elastic", "*Elastic, moduli=instantaneous"))
                  .materials[0]
                  .is_instantaneous);
}

TEST(InpReader, RefusesSetsWithParametersThatItDoesNotKnow) {
  EXPECT_THAT(ErrorOf(Replaced(kTet, "*NSET, NSET=Both", "*NSET, NSET=Both, SURFACE=S")),
              HasSubstr(":14: *NSET with SURFACE is not read"));
  EXPECT_THAT(ErrorOf(Replaced(kTet, "ELSET=E2", "ELSET=E2, NSET=Both")),
              HasSubstr(":16: *ELSET with NSET is not read"));
  EXPECT_EQ(
      Read(Replaced(kTet, "ELSET=E2", "ELSET=E2, instance=Part-1, unsorted")).element_sets.size(),
      2u);
}

TEST(InpReader, NotesSetsThatAreEmpty) {
  const ImportedModel model = Read(Replaced(kTet, "*Material", "*Nset, nset=none\n*Material"));
  EXPECT_EQ(model.node_sets.size(), 3u);
  EXPECT_THAT(model.notes, ElementsAre("set NONE: it is empty and was left out"));
  // Elements of other types are not read, so that what refers to them is empty.
  const ImportedModel shells =
      Read(Replaced(kTet, "*Material",
                    "*ELEMENT, TYPE=S3, ELSET=skin\n8, 10, 20, 30\n*ELSET, ELSET=E3\n8\n"
                    "*NSET, NSET=of_skin, ELSET=skin\n*Material"));
  EXPECT_THAT(shells.notes, ElementsAre("set OF_SKIN: it is empty and was left out",
                                        "set E3: it is empty and was left out"));
}

TEST(InpReader, GeneratesWithAStepThatSkipsNumbers) {
  const auto foot = [](const std::string& range) {
    return Read(Replaced(kTet, "10, 30, 10", range)).node_sets[1].nodes;
  };
  EXPECT_THAT(foot("10, 40, 30"), ElementsAre(0, 3));
  EXPECT_THAT(foot("20, 40, 20"), ElementsAre(1, 3));
  EXPECT_THAT(ErrorOf(Replaced(kTet, "10, 30, 10", "15, 2147483647, 2147483632")),
              HasSubstr(":13: 2 of the 2 numbers do not exist"));
}

// A set costs what it names, each time that it is named: many sets that name a large one would fill
// the memory.
TEST(InpReader, RefusesShortFilesThatNameHugeSets) {
  std::string text = "*NODE, NSET=A\n";
  for (int n = 1; n <= 2000; ++n) text += std::to_string(n) + ", 0, 0, 0\n";
  text += "*NSET, NSET=B\n";
  for (int k = 0; k < 20000; ++k) text += "A\n";
  EXPECT_THAT(ErrorOf(text),
              HasSubstr(":17003: the sets up to here have more than 30000000 entries"));
}

// Each beginning of a sound file is either read or refused, and never crashes.
TEST(InpReader, SurvivesTruncationAtEveryByte) {
  const std::string whole =
      InpText(Cantilever("linear", {1, 1, 1}, 2).Describe(), InpDialect::kCalculix);
  TemporaryFolder folder;
  for (size_t length = 0; length < whole.size(); length += 7) {
    std::ofstream(folder / "cut.inp", std::ios::binary) << whole.substr(0, length);
    try {
      EXPECT_GT(ReadInp(folder / "cut.inp").mesh.TetCount(), 0);
    } catch (const InputError&) {
      continue;
    }
  }
}

}  // namespace
}  // namespace lacuna
