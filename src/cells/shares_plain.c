/* Computes shares with the instructions that every processor has. */
#include "predicates/lanes_plain.h"

#define SHARES brio_shares_plain
#include "cells/share_lanes.h"
