//! The command line of Springpot as a library.
