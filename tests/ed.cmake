# Tests of this part; see hardbody_test in CMakeLists.txt.
