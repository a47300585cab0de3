// The plants of all machines: Machine::Plant<T> is whole with these (machines/<name>.hpp only names it).
#pragma once

#include "furcula/dynamics/axis.hpp"
#include "furcula/dynamics/hopper.hpp"
#include "furcula/dynamics/simple_clutch_bench.hpp"
