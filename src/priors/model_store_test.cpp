#include "priors/model_store.h"

#include <gmock/gmock.h>

#include <cstdlib>
#include <fstream>

#include "core/log.h"
#include "core/stop_signal.h"
#include "core/testing/error.h"
#include "io/atomic_file.h"
#include "io/safetensors.h"
#include "priors/http_download.h"
#include "priors/model_download.h"
#include "priors/testing/loopback_server.h"
#include "scene/sha256.h"

namespace aligngs {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

class Models : public testing::Test {
 protected:
  void SetUp() override {
    folder = fs::path(testing::TempDir()) /
             ("models_" + std::string(testing::UnitTest::GetInstance()->current_test_info()->name()));
    fs::remove_all(folder);
    set_log_level(LogLevel::kSilent);
    options.folder = folder / "own";
    options.huggingface = {folder / "hub"};
    options.torch = {folder / "checkpoints"};
    model.name = "toy";
    model.licence = {"MIT", "https://example.org/licence", "", false};
    model.files = {
        {"toy.safetensors", "http://127.0.0.1:1/toy.safetensors", "acme/toy", {"model.pt"}, 1000, false, "", "wanted"}};
  }
  void TearDown() override { set_log_level(LogLevel::kInfo); }

  void put(const fs::path& path, const std::string& tensor = "wanted") const {
    TensorFile file;
    file.tensors[tensor] = tensor_of({1, 2, 3});
    fs::create_directories(path.parent_path());
    write_safetensors(path, file);
  }
  /// model.safetensors with the probe tensor of Depth Anything 3, so wide.
  void put_camera_branch(const PublishedModel& network, int64_t columns) const {
    TensorFile file;
    file.tensors[network.files[0].probe] = tensor_of(std::vector<float>(size_t(3 * columns)), {3, columns});
    fs::create_directories(folder);
    write_safetensors(folder / "model.safetensors", file);
  }
  std::string bytes_of_a_good_file() const {
    put(folder / "good.safetensors");
    return read_file(folder / "good.safetensors");
  }
  const ModelFile& file() const { return model.files[0]; }
  ModelStore store() const { return ModelStore(options); }

  fs::path folder;
  ModelStoreOptions options;
  PublishedModel model;
};

TEST_F(Models, NamesAreUniqueAndWhatTheyNeedExists) {
  for (const PublishedModel& m : published_models()) {
    int same = 0;
    for (const PublishedModel& other : published_models()) same += other.name == m.name;
    EXPECT_EQ(same, 1) << m.name;
    EXPECT_NO_THROW(with_needs(m)) << m.name;
    EXPECT_FALSE(m.files.empty()) << m.name;
    EXPECT_GT(download_bytes(m), 0u) << m.name;
    for (const ModelFile& f : m.files) EXPECT_EQ(f.url.rfind("https://", 0), 0u) << f.url;
  }
}

TEST_F(Models, AHeadComesAfterItsBackbone) {
  const auto parts = with_needs(published_model("ade20k-linear-b"));
  ASSERT_EQ(parts.size(), 2u);
  EXPECT_EQ(parts[0]->name, "dinov2-b");
}

TEST_F(Models, AMistypedNameGetsASuggestion) {
  EXPECT_THAT(error_of(ErrorKind::kUsage, [] { published_model("vgt-1b"); }), HasSubstr("vggt-1b"));
}

TEST_F(Models, HuggingFaceCacheIsLookedInFirstThenOwnFolderThenTorch) {
  const fs::path theirs = options.huggingface[0] / "models--acme--toy" / "snapshots" / "r1" / "model.pt";
  const fs::path own = options.folder / "toy" / "toy.safetensors";
  put(theirs);
  put(own);
  put(options.torch[0] / "toy.safetensors");
  EXPECT_EQ(store().find(model, file())->place, ModelPlace::kHuggingFace);
  fs::remove(theirs);
  EXPECT_EQ(store().find(model, file())->place, ModelPlace::kOurs);
  fs::remove(own);
  EXPECT_EQ(store().find(model, file())->place, ModelPlace::kTorch);
}

TEST_F(Models, PlacesAreNamedInTheOrderInWhichTheyAreLookedAt) {
  const std::vector<fs::path> places = store().places(model, file());
  ASSERT_EQ(places.size(), 4u);
  EXPECT_EQ(places[0], options.huggingface[0] / "models--acme--toy/snapshots/*/toy.safetensors");
  EXPECT_EQ(places[1], options.huggingface[0] / "models--acme--toy/snapshots/*/model.pt");
  EXPECT_EQ(places[2], options.folder / "toy" / "toy.safetensors");
  EXPECT_EQ(places[3], options.torch[0] / "toy.safetensors");
}

TEST_F(Models, HuggingFaceCacheIsReadAtTheRevisionOfMain) {
  const fs::path repository = options.huggingface[0] / "models--acme--toy";
  put(repository / "snapshots" / "aaaa" / "toy.safetensors");
  put(repository / "snapshots" / "bbbb" / "toy.safetensors");
  fs::create_directories(repository / "refs");
  std::ofstream(repository / "refs" / "main") << "bbbb";
  const auto located = store().find(model, file());
  ASSERT_TRUE(located);
  EXPECT_EQ(located->path.parent_path().filename(), "bbbb");
}

TEST_F(Models, ABlobOfHuggingFaceNamesItsDigest) {
  const fs::path repository = options.huggingface[0] / "models--acme--toy";
  const std::string digest(64, 'a');
  put(repository / "blobs" / digest);
  fs::create_directories(repository / "snapshots" / "r1");
  fs::create_symlink("../../blobs/" + digest, repository / "snapshots" / "r1" / "toy.safetensors");
  EXPECT_EQ(store().digest(model, file(), *store().find(model, file())), digest);
}

TEST_F(Models, TorchCacheIsReadForFilesThatTorchFetches) {
  model.files[0].huggingface.clear();
  put(options.torch[0] / "toy.safetensors");
  EXPECT_EQ(store().find(model, file())->place, ModelPlace::kTorch);
}

TEST_F(Models, FirstUseRecordsTheDigest) {
  model.files[0].huggingface.clear();
  put(options.torch[0] / "toy.safetensors");
  const auto located = *store().find(model, file());
  const std::string digest = store().digest(model, file(), located);
  EXPECT_EQ(digest, sha256_of_file(located.path));
  ASSERT_TRUE(store().record(model, file()));
  EXPECT_EQ(store().record(model, file())->sha256, digest);
}

TEST_F(Models, AMissingModelSaysWhatToDownloadHowLargeAndWhereItWasLookedFor) {
  const std::string text = error_of(ErrorKind::kWeights, [&] { store().require(model); });
  EXPECT_THAT(text, HasSubstr("aligngs models download toy"));
  EXPECT_THAT(text, HasSubstr("1.0 kB"));
  EXPECT_THAT(text, HasSubstr((options.folder / "toy" / "toy.safetensors").string()));
  EXPECT_THAT(text, HasSubstr("models--acme--toy"));
}

TEST_F(Models, EnvironmentChoosesTheFolders) {
  setenv("ALIGNGS_MODELS", "/a", 1);
  setenv("HF_HOME", "/b", 1);
  setenv("HF_HUB_OFFLINE", "1", 1);
  unsetenv("HF_HUB_CACHE");
  const ModelStoreOptions o = ModelStoreOptions::from_environment(false);
  unsetenv("ALIGNGS_MODELS");
  unsetenv("HF_HOME");
  unsetenv("HF_HUB_OFFLINE");
  EXPECT_EQ(o.folder, "/a");
  EXPECT_EQ(o.huggingface[0], "/b/hub");
  EXPECT_TRUE(o.offline);
}

TEST_F(Models, ImportPutsAFileInPlace) {
  put(folder / "anything.bin");
  EXPECT_EQ(import_model_file(store(), model, folder / "anything.bin"), store().own_path(model, file()));
  EXPECT_TRUE(store().installed(model));
}

TEST_F(Models, AStoppedImportLeavesNothing) {
  put(folder / "anything.bin");
  request_stop();
  EXPECT_THROW(import_model_file(store(), model, folder / "anything.bin"), Error);
  clear_stop_request();
  EXPECT_FALSE(store().installed(model));
  size_t files = 0;
  if (fs::exists(store().options().folder))
    for (const auto& entry : fs::recursive_directory_iterator(store().options().folder))
      files += entry.is_regular_file() && entry.path().filename() != ".lock";
  EXPECT_EQ(files, 0u);
}

TEST_F(Models, ImportRefusesOtherWeights) {
  put(folder / "other.safetensors", "unwanted");
  EXPECT_THAT(error_of(ErrorKind::kWeights, [&] { import_model_file(store(), model, folder / "other.safetensors"); }),
              HasSubstr("wanted"));
  EXPECT_FALSE(store().installed(model));
}

TEST_F(Models, WeightsOfAnotherSizeAreRefusedUnderAWrongName) {
  const PublishedModel& base = published_model("da3-base");
  put_camera_branch(base, 2048);
  EXPECT_THAT(error_of(ErrorKind::kWeights, [&] { import_model_file(store(), base, folder / "model.safetensors"); }),
              testing::AllOf(HasSubstr("it holds \"da3-large\""), HasSubstr("models import da3-large")));
  const fs::path by_hand = store().own_path(base, base.files[0]);
  fs::create_directories(by_hand.parent_path());
  fs::copy_file(folder / "model.safetensors", by_hand);
  EXPECT_THAT(error_of(ErrorKind::kWeights, [&] { store().require(base); }),
              testing::AllOf(HasSubstr("da3-large"), HasSubstr("CC-BY-NC-4.0")));
}

TEST_F(Models, WeightsOfAnUnknownSizeAreTakenUnderAnyName) {
  const PublishedModel& base = published_model("da3-base");
  put_camera_branch(base, 64);
  import_model_file(store(), base, folder / "model.safetensors");
  EXPECT_EQ(store().require(base).size(), 1u);
}

TEST_F(Models, ImportSaysThatACutFileIsDamaged) {
  const std::string whole = bytes_of_a_good_file();
  write_file_atomically(folder / "cut.safetensors", whole.substr(0, whole.size() - 4));
  EXPECT_THAT(error_of(ErrorKind::kWeights, [&] { import_model_file(store(), model, folder / "cut.safetensors"); }),
              HasSubstr("copy or download the whole file again"));
}

TEST_F(Models, ImportRefusesAFileThatIsNotThePublishedOne) {
  model.files[0].sha256 = "0000";
  put(folder / "file.safetensors");
  error_of(ErrorKind::kWeights, [&] { import_model_file(store(), model, folder / "file.safetensors"); });
  EXPECT_FALSE(store().installed(model));
}

TEST_F(Models, VerifyAcceptsWhatCameUnchanged) {
  put(folder / "file.safetensors");
  import_model_file(store(), model, folder / "file.safetensors");
  const auto states = verify_model(store(), model);
  ASSERT_EQ(states.size(), 1u);
  EXPECT_TRUE(states[0].good) << states[0].problem;
  EXPECT_EQ(states[0].compared_with, "recorded");
}

TEST_F(Models, VerifyFindsAChangedByte) {
  put(folder / "file.safetensors");
  const fs::path path = import_model_file(store(), model, folder / "file.safetensors");
  std::fstream(path, std::ios::in | std::ios::out | std::ios::binary).seekp(-1, std::ios::end).put('x');
  EXPECT_FALSE(verify_model(store(), model)[0].good);
}

class ModelsFromAServer : public Models {
 protected:
  void SetUp() override {
    Models::SetUp();
    if (!can_download()) GTEST_SKIP() << "built without libcurl";
  }
  ModelDownloadOptions from(const LoopbackServer& server) const {
    ModelDownloadOptions o;
    o.mirror = server.url();
    o.first_pause = 0.001;
    o.attempts = 2;
    o.progress.enabled = false;
    return o;
  }
};

TEST_F(ModelsFromAServer, DownloadChecksAndRecords) {
  const std::string body = bytes_of_a_good_file();
  Sha256 sha;
  sha.update(body);
  const std::string digest = sha.finish();
  model.files[0].sha256 = digest.substr(0, 8);
  LoopbackServer server([&](const std::string&, int) { return LoopbackAnswer{body}; });
  download_model(store(), model, from(server));
  EXPECT_EQ(read_file(store().own_path(model, file())), body);
  EXPECT_EQ(store().record(model, file())->sha256, digest);
  EXPECT_EQ(store().record(model, file())->licence, "MIT");
  EXPECT_FALSE(fs::exists(part_of(store().own_path(model, file()))));
}

TEST_F(ModelsFromAServer, WhatIsThereIsNotAskedFor) {
  put(options.folder / "toy" / "toy.safetensors");
  LoopbackServer server([&](const std::string&, int) { return LoopbackAnswer{"never"}; });
  download_model(store(), model, from(server));
  EXPECT_TRUE(server.requests().empty());
}

TEST_F(ModelsFromAServer, AWrongDigestIsRefusedAndRemoved) {
  const std::string body = bytes_of_a_good_file();
  model.files[0].sha256 = "00000000";
  LoopbackServer server([&](const std::string&, int) { return LoopbackAnswer{body}; });
  EXPECT_THAT(error_of(ErrorKind::kWeights, [&] { download_model(store(), model, from(server)); }),
              HasSubstr("SHA-256"));
  EXPECT_FALSE(store().installed(model));
  EXPECT_FALSE(fs::exists(part_of(store().own_path(model, file()))));
}

TEST_F(ModelsFromAServer, AWebPageInPlaceOfWeightsIsRefused) {
  LoopbackServer server([&](const std::string&, int) { return LoopbackAnswer{"<html>please log in</html>"}; });
  error_of(ErrorKind::kWeights, [&] { download_model(store(), model, from(server)); });
  EXPECT_FALSE(store().installed(model));
}

TEST_F(ModelsFromAServer, ATruncatedFileStaysForTheNextTime) {
  const std::string body = bytes_of_a_good_file();
  LoopbackServer broken([&](const std::string&, int) {
    return LoopbackAnswer{body, "\"1\"", 200, false, body.size() / 2};
  });
  error_of(ErrorKind::kFailed, [&] { download_model(store(), model, from(broken)); });
  EXPECT_FALSE(store().installed(model));
  LoopbackServer whole([&](const std::string&, int) { return LoopbackAnswer{body}; });
  download_model(store(), model, from(whole));
  EXPECT_TRUE(store().installed(model));
}

TEST_F(ModelsFromAServer, OfflineNeverAsks) {
  options.offline = true;
  LoopbackServer server([&](const std::string&, int) { return LoopbackAnswer{"never"}; });
  EXPECT_THAT(error_of(ErrorKind::kWeights, [&] { download_model(store(), model, from(server)); }),
              HasSubstr("offline"));
  EXPECT_TRUE(server.requests().empty());
}

TEST_F(ModelsFromAServer, AModelLargerThanTheDiskIsRefusedBeforeAnyByte) {
  model.files[0].bytes = uint64_t(1) << 60;
  LoopbackServer server([&](const std::string&, int) { return LoopbackAnswer{"never"}; });
  error_of(ErrorKind::kResources, [&] { download_model(store(), model, from(server)); });
  EXPECT_TRUE(server.requests().empty());
}

TEST_F(Models, WithoutHomeTheFolderIsThatOfTheUser) {
  const char* home = std::getenv("HOME");
  const std::string before = home ? home : "";
  unsetenv("HOME");
  const ModelStoreOptions found = ModelStoreOptions::from_environment(true);
  if (home) setenv("HOME", before.c_str(), 1);
  EXPECT_TRUE(found.torch.at(0).is_absolute()) << found.torch.at(0);
}

}  // namespace
}  // namespace aligngs
