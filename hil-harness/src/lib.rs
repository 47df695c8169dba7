//! Does the loop keep its promises? Scenarios, devices under test and checkers.
