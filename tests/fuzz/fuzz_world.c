/* Reads any bytes as calls of the engine's public interface: the laws of random_calls.h hold. The first
 * byte is the profile. */
#include "fuzz.h"

#include "random_calls.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    random_calls_found found = {.broken = ""};
    if (size > 0) {
        random_calls_run(data + 1, size - 1, (pe_profile)(data[0] % 3), &found);
    }
    fuzz_check(found.broken[0] == '\0', found.broken);
    return 0;
}
