// SPDX-License-Identifier: MIT
// Runs a fuzz target once on every file named, or in every folder named: what ctest does with the kept inputs.
#include "tests/fuzz/Fuzz.h"

#include <fstream>
#include <iterator>

int main(int argc, char** argv)
{
    std::vector<std::filesystem::path> inputs;
    for (int k = 1; k < argc; ++k) {
        if (!std::filesystem::is_directory(argv[k]))
            inputs.emplace_back(argv[k]);
        else
            for (const auto& entry : std::filesystem::recursive_directory_iterator(argv[k]))
                if (entry.is_regular_file()) inputs.push_back(entry.path());
    }
    std::sort(inputs.begin(), inputs.end());
    if (inputs.empty()) {
        std::fprintf(stderr, "there is no input\n");
        return 1;
    }
    for (const auto& path : inputs) {
        std::printf("%s\n", path.filename().c_str());  // before it runs: the last one named is the one that failed
        std::fflush(stdout);
        std::ifstream in(path, std::ios::binary);
        if (!in) {
            std::fprintf(stderr, "it cannot be read\n");
            return 1;
        }
        const std::vector<char> bytes{std::istreambuf_iterator<char>(in), {}};
        LLVMFuzzerTestOneInput(reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size());
    }
    std::printf("%zu inputs\n", inputs.size());
    return 0;
}
