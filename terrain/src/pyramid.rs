//! Least and greatest heights over ever larger squares of cells.
