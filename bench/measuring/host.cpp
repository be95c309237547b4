// Reads /proc, and asks the allocator of glibc.
#include "measuring/host.h"

#include <malloc.h>
#include <unistd.h>

#include <fstream>

namespace motley::bench {

double host_load()
{
    std::ifstream file("/proc/loadavg");
    double load = -1;
    file >> load;
    return load;
}

double resident_bytes()
{
    std::ifstream file("/proc/self/statm");
    double all = 0, resident = 0;
    file >> all >> resident;
    return resident * static_cast<double>(sysconf(_SC_PAGESIZE));
}

double allocated_bytes()
{
    const struct mallinfo2 all = mallinfo2();
    return static_cast<double>(all.uordblks) + static_cast<double>(all.hblkhd);
}

}  // namespace motley::bench
