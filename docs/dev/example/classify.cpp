// SPDX-License-Identifier: MIT
// Opens a LAS or LAZ file, sets a class by a rule, and saves it, with the library alone:
//     classify IN OUT 'Classification = 7 if Z < 0'
#include <core/Error.h>
#include <core/session/Session.h>
#include <core/task/Progress.h>

#include <cstdio>

int main(int argc, char** argv)
{
    if (argc != 4) {
        std::fprintf(stderr, "Usage: classify IN OUT RULE\n");
        return 2;
    }
    try {
        // Who watches a long piece of work, or cancels it from another thread, shares this with it.
        punctum::Progress progress;

        const auto session = punctum::Session::open(argv[1]);
        for (const std::string& warning : session->read(progress).warnings)
            std::fprintf(stderr, "%s\n", warning.c_str());

        // A step by its name, as `punctum process --list-steps` tells them, with its values.
        const auto edit = session->edit({"set", {{"rule", argv[3]}}, nullptr}, progress);

        // Written beside its place, read back, compared, and then renamed.
        const auto saved = session->save({argv[2], {}}, progress);
        std::printf("%llu points changed; %s\n", static_cast<unsigned long long>(edit.changed),
                    punctum::las::summary(saved.preview.difference).c_str());
        return 0;
    } catch (const punctum::Error& error) {
        std::fprintf(stderr, "%s\n", error.what());
        return 1;
    }
}
