// Empty: this file exists to compile the precompiled header of the tests.
