# Fits in a process of its own. Reads lines: "load FILE", a file of single-precision colors; "lts SEED"; "bare SEED", the same without the robust distances of
# the regressors, which ltsReg computes besides and which are half of its time; "lms SEED". Answers a fit with the
# CPU time in milliseconds and twelve coefficients: those of the robust fit, and those after the last step by least squares.
suppressPackageStartupMessages({ library(robustbase); library(MASS) })
input <- file("stdin", "r")
while (length(line <- readLines(input, 1)) > 0) {
    words <- strsplit(line, " ")[[1]]
    if (words[1] == "load") {
        count <- file.size(words[2]) / 4
        colors <- matrix(readBin(words[2], "numeric", count, size = 4) / 255, ncol = 3, byrow = TRUE)
        r <- colors[, 1]; g <- colors[, 2]; b <- colors[, 3]
        x <- cbind(r * r, g * g, b * b, 2 * r * g, 2 * r * b, 2 * g * b)
        y <- rep(1, nrow(x))
        answer <- 0
    } else {
        set.seed(as.integer(words[2]))
        is_lts <- words[1] != "lms"
        time <- system.time(fit <- if (is_lts) ltsReg(x, y, intercept = FALSE, mcd = words[1] == "lts")
                            else lqs(x, y, intercept = FALSE, method = "lms"))
        robust <- if (is_lts) fit$raw.coefficients else fit$coefficients
        answer <- c(1000 * (time[["user.self"]] + time[["sys.self"]]), c(robust, fit$coefficients) / 255^2)
    }
    cat(format(answer, digits = 17), "\n")
    flush(stdout())
}
