/// Pipeline files made for dumps.
#include <filesystem>

#include <gmock/gmock.h>

#include "cli/command.hpp"
#include "cli/example_dumps.hpp"
#include "support/sample_dumps.hpp"

namespace grainvdb::test::init_test {
namespace {

using ::grainvdb::testing::in_repository;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

TEST(Init, WritesAFileThatRuns) {
  const Folder folder;
  write_dumps(folder);
  const CommandResult made =
      run_command({"init", "frames/dump*.txt", "--contacts", "frames/contacts*.txt", "--dt", "0.5", "-o", "my.yaml"},
                  folder.path());
  ASSERT_EQ(made.exit_code, 0) << made.err;
  EXPECT_EQ(made.out, "wrote my.yaml with 12 fields\n");
  // Diameter 1 in a periodic box of 4: half the box is less than three diameters.
  EXPECT_THAT(read_file(folder / "my.yaml"),
              AllOf(HasSubstr("particles: \"frames/dump*.txt\""), HasSubstr("dt: 0.5"), HasSubstr("types: [1, 2]"),
                    HasSubstr("# units: si"), HasSubstr("voxel: 0.5\n"), HasSubstr("cutoff: 2.0\n"),
                    HasSubstr("    - gd_over_dv")));
  const CommandResult run = run_command({"run", "my.yaml", "-o", "out"}, folder.path());
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(folder.names_in("out"), ::testing::ElementsAre("fields.hdf", "run.json"));
}

TEST(Init, AsksOnlyForWhatTheDumpsGive) {
  const Folder folder;
  folder.write("d.txt", dump_text(0, "id x y z radius"));
  ASSERT_EQ(run_command({"init", "d.txt"}, folder.path()).exit_code, 0);
  EXPECT_THAT(read_file(folder / "pipeline.yaml"),
              AllOf(HasSubstr("\n    - phi"), HasSubstr("\n    # - velocity"), HasSubstr("\n    # - stress"),
                    HasSubstr("needs contacts"), Not(HasSubstr("select:")), Not(HasSubstr("\n  dt:"))));
  EXPECT_EQ(run_command({"validate", "pipeline.yaml"}, folder.path()).exit_code, 0);
}

TEST(Init, LeavesOutWallsThatRestOrMoveAsOne) {
  const Folder folder;
  std::string rows;
  for (int i = 0; i < 8; ++i) {
    const int type = 1 + i % 3;  // 1 flows, 2 moves as one body, 3 rests
    const int speed = type == 1 ? i : type == 2 ? 3 : 0;
    rows += std::to_string(i + 1) + ' ' + std::to_string(type) + ' ' + std::to_string(i) + " 1 1 " +
            std::to_string(speed) + " 0 0 0.5\n";
  }
  folder.write("d.txt",
               "ITEM: TIMESTEP\n0\nITEM: NUMBER OF ATOMS\n8\nITEM: BOX BOUNDS ff ff ff\n0 8\n0 2\n0 2\n"
               "ITEM: ATOMS id type x y z vx vy vz radius\n" +
                   rows);
  const CommandResult info = run_command({"info", "d.txt"}, folder.path());
  EXPECT_THAT(info.out, AllOf(HasSubstr("type 1: 3, diameter 1, flowing\n"),
                              HasSubstr("type 2: 3, diameter 1, moving as one body\n"),
                              HasSubstr("type 3: 2, diameter 1, at rest\n"),
                              HasSubstr("suggested: kernel.cutoff 3.0 (3 mean diameters), lattice.voxel 0.5\n")));
  ASSERT_EQ(run_command({"init", "d.txt"}, folder.path()).exit_code, 0);
  EXPECT_THAT(read_file(folder / "pipeline.yaml"), HasSubstr("types: [1]\n"));
}

TEST(Init, SaysThatItCannotTellContactColumnsApart) {
  const Folder folder;
  write_dumps(folder);
  std::string contacts = contacts_text(0);
  const std::string names = "id1 id2 fx fy fz";
  contacts.replace(contacts.find(names), names.size(), "c_c[1] c_c[2] c_c[3] c_c[4] c_c[5]");
  folder.write("c.txt", contacts);
  const CommandResult made = run_command({"init", "frames/dump0.txt", "--contacts", "c.txt"}, folder.path());
  ASSERT_EQ(made.exit_code, 0) << made.err;
  EXPECT_THAT(made.out, HasSubstr("--contact-compute"));
  EXPECT_THAT(read_file(folder / "pipeline.yaml"), AllOf(HasSubstr("  #   c_c[1] c_c[2] c_c[3] c_c[4] c_c[5]\n"),
                                                         HasSubstr("  #   compute: ["), Not(HasSubstr("lammps:"))));
  EXPECT_EQ(run_command({"validate", "pipeline.yaml"}, folder.path()).exit_code, 0);
}

TEST(Init, NamesTheTwoComputesOfLammps) {
  const Folder folder;
  ASSERT_EQ(run_command({"init", in_repository("sample_dumps/formats/lammps.dump"), "--contacts",
                         in_repository("sample_dumps/formats/lammps_contacts.dump")},
                        folder.path())
                .exit_code,
            0);
  EXPECT_THAT(read_file(folder / "pipeline.yaml"), HasSubstr("  #   lammps: {ids: id, forces: force}"));
}

TEST(Init, TakesTheTwoComputesOfLammps) {
  const Folder folder;
  const std::vector<std::string> dumps{"init", in_repository("sample_dumps/formats/lammps.dump"), "--contacts",
                                       in_repository("sample_dumps/formats/lammps_contacts.dump")};
  std::vector<std::string> words = dumps;
  words.insert(words.end(), {"--contact-lammps", "id", "force"});
  const CommandResult made = run_command(words, folder.path());
  ASSERT_EQ(made.exit_code, 0) << made.err;
  EXPECT_EQ(made.out, "wrote pipeline.yaml with 12 fields\n");
  EXPECT_THAT(read_file(folder / "pipeline.yaml"), HasSubstr("\n    lammps: {ids: id, forces: force} "));
  EXPECT_EQ(run_command({"run", "pipeline.yaml", "-o", "out"}, folder.path()).exit_code, 0);
}

TEST(Init, RefusesComputesThatDoNotFitTheDumps) {
  const Folder folder;
  const std::string sample = in_repository("sample_dumps/");
  const CommandResult lammps = run_command({"init", sample + "formats/lammps.dump", "--contacts",
                                            sample + "formats/lammps_contacts.dump", "--contact-lammps", "pp", "force"},
                                           folder.path());
  EXPECT_EQ(lammps.exit_code, 2) << lammps.out;
  EXPECT_THAT(lammps.err, HasSubstr("c_pp[1]"));
  const CommandResult one = run_command({"init", sample + "formats/lammps.dump", "--contacts",
                                         sample + "formats/lammps_contacts.dump", "--contact-lammps", "id", "-o", "x"},
                                        folder.path());
  EXPECT_EQ(one.exit_code, 1) << one.out;
  EXPECT_THAT(one.err, HasSubstr("two names of computes are needed"));
  const CommandResult liggghts =
      run_command({"init", sample + "shear_cell/dump*", "--contacts", sample + "shear_cell/contacts*",
                   "--contact-compute", "pos", "id", "force"},
                  folder.path());
  EXPECT_EQ(liggghts.exit_code, 2) << liggghts.out;
  EXPECT_THAT(liggghts.err, HasSubstr("List every keyword of the compute"));
  EXPECT_FALSE(std::filesystem::exists(folder / "pipeline.yaml"));
}

TEST(Init, TakesTheBoxThatVtkFilesLack) {
  const Folder folder;
  const std::string grains = in_repository("sample_dumps/formats/liggghts_ascii_*.vtk");
  const CommandResult asked = run_command({"init", grains, "--periodic", "x"}, folder.path());
  EXPECT_EQ(asked.exit_code, 1);
  EXPECT_THAT(asked.err, HasSubstr("--box of info and init"));
  const CommandResult made =
      run_command({"init", grains, "--periodic", "x", "--box", "0", "0", "0", "0.004", "0.01", "0.01"}, folder.path());
  ASSERT_EQ(made.exit_code, 0) << made.err;
  EXPECT_THAT(
      read_file(folder / "pipeline.yaml"),
      AllOf(HasSubstr("  periodic: x\n"), HasSubstr("  box: {lo: [0.0, 0.0, 0.0], hi: [0.004, 0.01, 0.01]}\n")));
  EXPECT_EQ(run_command({"validate", "pipeline.yaml"}, folder.path()).exit_code, 0);
}

TEST(Init, TakesContactsWithWalls) {
  const Folder folder;
  const std::string sample = grainvdb::testing::in_repository("sample_dumps/formats/");
  const std::vector<std::string> dumps{"init",
                                       sample + "mesh_grains_*.dump",
                                       "--contacts",
                                       sample + "mesh_pairs_*.dump",
                                       "--contact-compute",
                                       "id",
                                       "force",
                                       "--wall-contacts",
                                       sample + "mesh_walls_*.dump"};
  std::vector<std::string> words = dumps;
  words.insert(words.end(), {"--wall-contact-compute", "pos", "id", "force", "contactPoint"});
  const CommandResult made = run_command(words, folder.path());
  ASSERT_EQ(made.exit_code, 0) << made.err;
  EXPECT_EQ(made.out, "wrote pipeline.yaml with 12 fields\n");
  EXPECT_THAT(read_file(folder / "pipeline.yaml"),
              AllOf(HasSubstr("\n  wall_contacts:       # "),
                    HasSubstr("\n    files: \"" + sample +
                              "mesh_walls_*.dump\"\n    compute: [\"pos\", \"id\", \"force\", \"contactPoint\"]\n")));
  EXPECT_EQ(run_command({"run", "pipeline.yaml", "-o", "out", "--set", "output.fields=[wall_force]"}, folder.path())
                .exit_code,
            0);

  words = dumps;
  words.insert(words.end(), {"-o", "unknown.yaml"});
  const CommandResult unknown = run_command(words, folder.path());
  ASSERT_EQ(unknown.exit_code, 0) << unknown.err;
  EXPECT_THAT(unknown.out,
              HasSubstr("see input.wall_contacts there, or name them with\n--wall-contact-compute (LIGGGHTS).\n"));
  EXPECT_THAT(read_file(folder / "unknown.yaml"),
              AllOf(HasSubstr("\n  #   c_wl[1] c_wl[2]"), HasSubstr("\n  # wall_contacts:\n  #   files: \"")));
  EXPECT_EQ(run_command({"validate", "unknown.yaml"}, folder.path()).exit_code, 0);
}

TEST(Init, TakesContactsWithWallsThatStandAmongTheOthers) {
  const Folder folder;
  const std::string sample = in_repository("sample_dumps/formats/");
  const auto init = [&](const std::string& name, const std::string& file) {
    return run_command({"init", sample + name + ".data", "--contacts", sample + name + ".fstat", "--periodic", "none",
                        "--density", "2.5", "-o", file},
                       folder.path());
  };
  ASSERT_EQ(init("settled", "walls.yaml").exit_code, 0);
  EXPECT_THAT(read_file(folder / "walls.yaml"), HasSubstr("  wall_contacts:       # with walls that are no grains; "
                                                          "stresses take them in\n    files: \"" +
                                                          sample + "settled.fstat\"\n"));
  EXPECT_EQ(run_command({"validate", "walls.yaml"}, folder.path()).exit_code, 0);

  std::string pairs = "# 80 1\n# 0 0 0 2.4 2.4 6\n# 0 0 0 0 0 0\n";
  folder.write("none.fstat", pairs + "80 0 1 0 0 0 0.01 0 2 0 1 0 0 0 0 0\n80 1 0 0 0 0 0.01 0 2 0 -1 0 0 0 0 0\n");
  folder.write("none.data", "2 80 0 0 0 2.4 2.4 6\n1 1 1 0 0 0 0.5 0 0 0 0 0 0 0\n0.1 1 1 0 0 0 0.5 0 0 0 0 0 0 0\n");
  const CommandResult none = run_command(
      {"init", "none.data", "--contacts", "none.fstat", "--periodic", "none", "--density", "2.5", "-o", "none.yaml"},
      folder.path());
  ASSERT_EQ(none.exit_code, 0) << none.err;
  EXPECT_THAT(read_file(folder / "none.yaml"), Not(HasSubstr("wall_contacts")));
}

TEST(Init, RefusesWhatItCannotDo) {
  const Folder folder;
  write_dumps(folder);
  folder.write("my.yaml", "mine");
  const CommandResult there = run_command({"init", "frames/dump0.txt", "-o", "my.yaml"}, folder.path());
  EXPECT_EQ(there.exit_code, 1);
  EXPECT_THAT(there.err, HasSubstr("my.yaml: the file is there already"));
  EXPECT_EQ(read_file(folder / "my.yaml"), "mine");

  folder.write("d.txt", dump_text(0, "id type x y z"));
  const CommandResult sizes = run_command({"init", "d.txt"}, folder.path());
  EXPECT_EQ(sizes.exit_code, 2);
  EXPECT_THAT(sizes.err, HasSubstr("--radius"));
  EXPECT_EQ(run_command({"init", "d.txt", "--radius", "0.5"}, folder.path()).exit_code, 0);

  // Periods of 4 and 3.7 have no common divisor between a quarter and 0.6 of a diameter.
  std::string odd = dump_text(0);
  odd.replace(odd.find("0 4\n"), 4, "0 3.713\n");
  folder.write("odd.txt", odd);
  const CommandResult voxel = run_command({"init", "odd.txt", "-o", "odd.yaml"}, folder.path());
  EXPECT_EQ(voxel.exit_code, 2);
  EXPECT_THAT(voxel.err, HasSubstr("fits all periodic lengths"));
  EXPECT_EQ(run_command({"init", "frames/dump0.txt", "-o", "no/such/my.yaml"}, folder.path()).exit_code, 3);
}

}  // namespace
}  // namespace grainvdb::test::init_test
