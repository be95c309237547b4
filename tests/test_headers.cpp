// Nothing of its own: the headers that most tests include are compiled with this file (CMakeLists.txt).
