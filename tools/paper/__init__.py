"""The study of De Michele, Schilling and Sciortino, made again: state points, runs, results, figures, verdicts."""
