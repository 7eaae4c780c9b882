// SPDX-License-Identifier: MIT
// The library alone, with no Qt and no OpenGL (preset core-only): a survey is made, saved as LAS and LAZ, opened,
// edited by a rule, undone, saved, compared; and assertions are on, as in every build that is tested.
#include "core/Error.h"
#include "core/cloud/PointCloud.h"
#include "core/edit/Command.h"
#include "core/las/Diff.h"
#include "core/las/Reader.h"
#include "core/las/Writer.h"
#include "core/sample/Sample.h"
#include "core/session/Session.h"
#include "core/task/Progress.h"

#include <sys/wait.h>
#include <unistd.h>

#include <cassert>
#include <csignal>
#include <cstdio>
#include <filesystem>
#include <string>

using namespace punctum;

namespace
{

int failures = 0;

void check(bool holds, const char* what)
{
    std::printf("%s: %s\n", holds ? "ok" : "FAILED", what);
    if (!holds) ++failures;
}

/// Whether a broken promise ends the process by SIGABRT.
bool aborts(void (*broken)())
{
    const pid_t child = ::fork();
    if (child == 0) {
        std::fclose(stderr);
        broken();
        ::_exit(0);
    }
    int status = 0;
    ::waitpid(child, &status, 0);
    return WIFSIGNALED(status) && WTERMSIG(status) == SIGABRT;
}

/// A set of points of another cloud.
void breakThePromiseOfSizes()
{
    Progress progress;
    const auto cloud = makeSample(100, 1, progress);
    const ValueCommand wrong("wrong", *cloud->findAttribute("Classification"), std::make_shared<PointSet>(7), {});
}

void opensEditsAndSaves(const std::filesystem::path& folder, const std::string& ending)
{
    Progress progress;
    const auto path = folder / ("made" + ending), edited = folder / ("edited" + ending);
    las::WriteOptions options;
    options.compressed = las::isCompressedName(path);
    las::write(*makeSample(20'000, 7, progress), path, options, progress);

    const auto session = Session::open(path);
    session->read(progress);
    check(session->cloud()->size() == 20'000, "all points are there");
    const EditOutcome edit =
        session->edit({"set", {{"rule", "Classification = 6 if Classification == 5"}}, nullptr}, progress);
    check(edit.changed > 0, "the rule changes points");
    check(session->history().modified(), "an edit is noticed");
    session->save({edited, {}}, progress);
    check(!session->history().modified(), "a save is noticed");
    const auto difference = las::diffFiles(path, edited, {}, progress);
    check(difference.attributes.size() == 1 && difference.attributes[0].name == "Classification",
          "nothing but the class differs");
    session->undo(progress);
    session->save({edited, {}}, progress);
    check(las::diffFiles(path, edited, {}, progress).attributes.empty(), "undone, no point differs");
}

void refusesWhatIsNoCloud(const std::filesystem::path& folder)
{
    const auto path = folder / "no.las";
    std::FILE* const file = std::fopen(path.c_str(), "w");
    std::fputs("<!DOCTYPE html><html></html>", file);
    std::fclose(file);
    std::string told;
    try {
        las::Reader::open(path);
    } catch (const Error& error) {
        told = error.what();
    }
    check(told.find("no.las") != std::string::npos && told.ends_with('.'),
          "another file is refused with a sentence");
}

}  // namespace

/// `LibraryTest --sample FILE` only writes a survey.
int main(int argc, char** argv)
{
    if (argc == 3 && std::string(argv[1]) == "--sample") {
        Progress progress;
        las::WriteOptions options;
        options.compressed = las::isCompressedName(argv[2]);
        las::write(*makeSample(2'000, 3, progress), argv[2], options, progress);
        return 0;
    }
    std::string name = (std::filesystem::temp_directory_path() / "punctum-library-XXXXXX").string();
    if (::mkdtemp(name.data()) == nullptr) return 1;
    check(aborts([] { assert(failures < 0); }), "an assertion of a test that fails ends it");
    check(aborts(breakThePromiseOfSizes), "an assertion of the library that fails ends it");
    opensEditsAndSaves(name, ".las");
    opensEditsAndSaves(name, ".laz");
    refusesWhatIsNoCloud(name);
    std::filesystem::remove_all(name);
    return failures == 0 ? 0 : 1;
}
