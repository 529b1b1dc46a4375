// Weights as a user meets them: listed, refused, fetched, found missing.
#include <gmock/gmock.h>

#include <cstdlib>
#include <optional>

#include "io/atomic_file.h"
#include "io/image_file.h"
#include "io/safetensors.h"
#include "priors/http_download.h"
#include "priors/testing/loopback_server.h"
#include "support/no_weights.h"
#include "support/process.h"

namespace aligngs {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;
using testing_support::ProcessResult;
using testing_support::run_aligngs;

/// A machine without any weights.
class ModelsProgram : public testing::Test {
 protected:
  void SetUp() override {
    folder = fs::path(testing::TempDir()) /
             ("models_program_" + std::string(testing::UnitTest::GetInstance()->current_test_info()->name()));
    fs::remove_all(folder);
    fs::create_directories(folder / "photos");
    no_weights.emplace(folder);
    for (const char* name : {"a.jpg", "b.jpg", "c.jpg"})
      write_jpeg(folder / "photos" / name, Image<uint8_t>(64, 48, 3, 80));
  }
  ProcessResult run(const std::string& arguments) const { return run_aligngs(arguments, folder / "scratch"); }
  std::string photos() const { return "'" + (folder / "photos").string() + "'"; }
  std::string out(const char* name) const { return "'" + (folder / name).string() + "'"; }
  /// Bytes of a weight file with one tensor.
  std::string file_with(const std::string& tensor) const {
    TensorFile file;
    file.tensors[tensor] = tensor_of({1, 2});
    write_safetensors(folder / "one.safetensors", file);
    return read_file(folder / "one.safetensors");
  }

  fs::path folder;
  std::optional<testing_support::NoWeights> no_weights;
};

TEST_F(ModelsProgram, ListNamesSizeLicenceSourceAndDigest) {
  const ProcessResult result = run("models list");
  EXPECT_EQ(result.status, 0);
  EXPECT_THAT(result.out, AllOf(HasSubstr("vggt-1b"), HasSubstr("5.0 GB"), HasSubstr("CC-BY-NC-4.0"),
                                HasSubstr("non-commercial"), HasSubstr("https://huggingface.co/facebook/VGGT-1B"),
                                HasSubstr("sha256"), HasSubstr("Apache-2.0")));
  EXPECT_THAT(run("models list --json").out, HasSubstr("\"sha256_published\""));
}

TEST_F(ModelsProgram, AMissingModelIsStatusFour) {
  const ProcessResult result = run("models path vggt-1b");
  EXPECT_EQ(result.status, 4);
  EXPECT_THAT(result.err, AllOf(HasSubstr("aligngs models download vggt-1b"), HasSubstr("5.0 GB"),
                                HasSubstr((folder / "models").string())));
  EXPECT_EQ(run("models verify vggt-1b").status, 4);
}

TEST_F(ModelsProgram, ALicenceMustBeAccepted) {
  const ProcessResult result = run("models download vggt-1b </dev/null");
  EXPECT_EQ(result.status, 2);
  EXPECT_THAT(result.err, AllOf(HasSubstr("CC-BY-NC-4.0"), HasSubstr("--accept-licence")));
}

TEST_F(ModelsProgram, OfflineForbidsTheNetwork) {
  const ProcessResult result = run("models download vggt-1b --accept-licence --offline");
  EXPECT_EQ(result.status, 4);
  EXPECT_THAT(result.err, HasSubstr("offline"));
}

TEST_F(ModelsProgram, AMistypedModelIsAUsageError) {
  EXPECT_EQ(run("models path vgtt-1b").status, 2);
  EXPECT_EQ(run("models").status, 2);
}

TEST_F(ModelsProgram, DownloadVerifyAndPathWorkTogether) {
  if (!can_download()) GTEST_SKIP() << "built without libcurl";
  const std::string head = file_with("decode_head.conv_seg.weight"), backbone = file_with("blocks.0.attn.qkv.weight");
  LoopbackServer server([&](const std::string& path, int) {
    return LoopbackAnswer{path.find("pretrain") != std::string::npos ? backbone : head};
  });
  const ProcessResult got = run("models download ade20k-linear-s --accept-licence --from " + server.url());
  EXPECT_EQ(got.status, 0) << got.err;
  EXPECT_THAT(got.out,
              AllOf(HasSubstr("dinov2_vits14_pretrain.pth"), HasSubstr("dinov2_vits14_ade20k_linear_head.pth")));
  EXPECT_EQ(run("models verify").status, 0);
  EXPECT_THAT(run("models path ade20k-linear-s").out, HasSubstr("dinov2_vits14_ade20k_linear_head.pth"));
  const size_t before = server.requests().size();
  EXPECT_EQ(run("models download ade20k-linear-s --from " + server.url()).status, 0);
  EXPECT_EQ(server.requests().size(), before);
  write_file_atomically(folder / "models" / "dinov2-s" / "dinov2_vits14_pretrain.pth", head);
  EXPECT_EQ(run("models verify").status, 4);
}

TEST_F(ModelsProgram, ImportTakesAFileOfTheRightNetworkOnly) {
  file_with("aggregator.camera_token");
  EXPECT_EQ(run("models import ade20k-m2f " + out("one.safetensors")).status, 4);
  EXPECT_EQ(run("models import vggt-1b " + out("one.safetensors")).status, 0);
  EXPECT_EQ(run("models path vggt-1b").status, 0);
}

TEST_F(ModelsProgram, TheCacheOfHuggingFaceIsUsedBeforeAnImportedFile) {
  const fs::path cached = folder / "hub" / "models--facebook--VGGT-1B" / "snapshots" / "r1" / "model.safetensors";
  write_file_atomically(cached, file_with("aggregator.camera_token"));
  const ProcessResult imported = run("models import vggt-1b " + out("one.safetensors"));
  EXPECT_EQ(imported.status, 0);
  EXPECT_THAT(imported.err, HasSubstr(cached.string() + " is used instead"));
  EXPECT_THAT(run("models path vggt-1b").out, HasSubstr(cached.string()));
}

TEST_F(ModelsProgram, DoctorSaysWhichWeightsAreWhere) {
  const ProcessResult none = run("doctor");
  EXPECT_THAT(none.out,
              AllOf(HasSubstr("0 of "), HasSubstr((folder / "models").string()), HasSubstr((folder / "hub").string())));
  write_file_atomically(folder / "models" / "ade20k-linear-s" / "dinov2_vits14_ade20k_linear_head.pth",
                        file_with("decode_head.conv_seg.weight"));
  const ProcessResult head = run("doctor");
  EXPECT_THAT(head.out, AllOf(HasSubstr("0 of "), HasSubstr("of no use yet without dinov2-s")));
  write_file_atomically(folder / "torch" / "hub" / "checkpoints" / "dinov2_vits14_pretrain.pth",
                        file_with("blocks.0.attn.qkv.weight"));
  const ProcessResult both = run("doctor");
  EXPECT_THAT(both.out, AllOf(HasSubstr("2 of "), HasSubstr((folder / "torch" / "hub").string())));
}

TEST_F(ModelsProgram, InfoListsTheTensorsOfAWeightFileWhateverItsName) {
  write_file_atomically(folder / "head.pth", file_with("decode_head.conv_seg.weight"));
  EXPECT_THAT(run("info " + out("head.pth")).out,
              AllOf(HasSubstr("decode_head.conv_seg.weight"), HasSubstr("ade20k-linear-s")));
}

TEST_F(ModelsProgram, CamerasAreForTheMethodGivenOnly) {
  EXPECT_EQ(run("poses " + photos() + " -o " + out("scene") + " --method colmap --cameras sparse").status, 2);
  const ProcessResult result = run("poses " + photos() + " -o " + out("scene") + " --method given");
  EXPECT_EQ(result.status, 3);
  EXPECT_THAT(result.err, HasSubstr("--cameras"));
}

TEST_F(ModelsProgram, PosesWithoutWeightsOffersColmap) {
  const ProcessResult result = run("poses " + photos() + " -o " + out("scene"));
  EXPECT_EQ(result.status, 4);
  EXPECT_THAT(result.err, AllOf(HasSubstr("aligngs models download recommended"), HasSubstr("3.1 GB"),
                                HasSubstr("light"), HasSubstr("--method colmap")));
  EXPECT_FALSE(fs::exists(folder / "scene"));
}

TEST_F(ModelsProgram, PosesByDepthAnything3NameItsOwnWeightsAndLicence) {
  const std::string command = "poses " + photos() + " -o " + out("scene");
  const ProcessResult base = run(command + " --method da3");
  EXPECT_EQ(base.status, 4);
  EXPECT_THAT(base.err, AllOf(HasSubstr("aligngs models download da3-base"), HasSubstr("Apache-2.0"),
                              HasSubstr("--method colmap")));
  EXPECT_THAT(run(command + " --method da3 --poses-model da3-large").err, HasSubstr("non-commercial"));
  EXPECT_EQ(run(command + " --method da3 --poses-model vggt-1b").status, 2);
  // its method follows
  EXPECT_THAT(run(command + " --poses-model da3-small").err, HasSubstr("aligngs models download da3-small"));
  EXPECT_EQ(run(command + " --method colmap --camera-from-rays").status, 2);
  EXPECT_EQ(run(command + " --method colmap --metres da3metric-large").status, 2);
  EXPECT_FALSE(fs::exists(folder / "scene"));
}

TEST_F(ModelsProgram, ASetIsShownWithSizesLicencesAndTimesBeforeAnythingIsFetched) {
  const ProcessResult result = run("models download recommended </dev/null");
  EXPECT_EQ(result.status, 2) << "nobody accepted the licence";
  EXPECT_THAT(result.err, AllOf(HasSubstr("da3-base"), HasSubstr("da3metric-large"), HasSubstr("eomt-l"),
                                HasSubstr("Apache-2.0"), HasSubstr("about "), HasSubstr("to fetch: 3.1 GB")));
  EXPECT_FALSE(fs::exists(folder / "models"));
}

TEST_F(ModelsProgram, AnOpenQuestionAboutWeightsIsShownBeforeTheDownload) {
  EXPECT_THAT(run("models download lingbot-map </dev/null").err,
              HasSubstr("open question: whether these weights started from VGGT-1B"));
}

TEST_F(ModelsProgram, DoctorListsTheOrderOfNetworksWithReasons) {
  const ProcessResult result = run("doctor");
  EXPECT_THAT(result.out,
              AllOf(HasSubstr("1. vggt-1b-commercial"), HasSubstr("2. da3-base: free to use"),
                    HasSubstr("non-commercial use only"), HasSubstr("11. linear-s: metres, one photo at a time"),
                    HasSubstr("by accuracy on ADE20K: m2f, eomt-l")));
}

TEST_F(ModelsProgram, AFileOfEitherLayoutOfEomtIsTakenIn) {
  for (const char* const tensor : {"network.q.weight", "query.weight"}) {
    write_file_atomically(folder / "eomt.bin", file_with(tensor));
    EXPECT_THAT(run("info " + out("eomt.bin")).out, HasSubstr("eomt-l"));
    EXPECT_EQ(run("models import eomt-l " + out("eomt.bin")).status, 0) << tensor;
  }
  write_file_atomically(folder / "other.bin", file_with("neck.convs.0.weight"));
  EXPECT_NE(run("models import eomt-l " + out("other.bin")).status, 0);
}

TEST_F(ModelsProgram, RunOnPhotosWithoutWeightsSaysWhichCommandGetsThem) {
  const ProcessResult result = run("run " + photos() + " -o " + out("run"));
  EXPECT_EQ(result.status, 4);
  EXPECT_THAT(result.err, AllOf(HasSubstr("aligngs models download recommended"), HasSubstr("3.1 GB"),
                                HasSubstr("--method colmap --semantics none")));
}

TEST_F(ModelsProgram, RunWithNamedSemanticsNeedsTheirWeightsFirst) {
  const ProcessResult result = run("run " + photos() + " -o " + out("run") + " --method colmap --semantics linear-b");
  EXPECT_EQ(result.status, 4);
  EXPECT_THAT(result.err, HasSubstr("aligngs models download ade20k-linear-b"));
  EXPECT_FALSE(fs::exists(folder / "run" / "scene"));
}

TEST_F(ModelsProgram, AFolderOfNeitherPhotosNorASceneIsBadInput) {
  fs::create_directories(folder / "empty");
  EXPECT_EQ(run("run " + out("empty") + " -o " + out("run")).status, 3);
  EXPECT_EQ(run("poses " + out("empty") + " -o " + out("scene") + " --method colmap").status, 3);
}

TEST_F(ModelsProgram, ColmapThatIsNotInstalledIsNamed) {
  const std::string path = std::getenv("PATH");
  setenv("PATH", (folder / "empty").c_str(), 1);
  const ProcessResult result = run("poses " + photos() + " -o " + out("scene") + " --method colmap");
  setenv("PATH", path.c_str(), 1);
  EXPECT_EQ(result.status, 1);
  EXPECT_THAT(result.err, HasSubstr("apt-get install colmap"));
}

}  // namespace
}  // namespace aligngs
